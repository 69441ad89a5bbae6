// What is drawn: rods as swept sections, actuators, bodies, arrows, derivatives. World axes, z up, metres.

const RING = 14; // Corners of a round section.
const AXES_EVERY = 6; // Sections whose axes are drawn.
const AXES_COLOURS = ["#cc3311", "#228833"];
const DERIVATIVES = "#0077bb";
const THINNEST = 0.004; // Least half width of what is drawn, relative to the scene.

class Scenery {
  constructor(canvas, facts) {
    this.canvas = canvas;
    this.facts = facts;
    this.least = new THREE.Vector3(...facts.least);
    this.most = new THREE.Vector3(...facts.most);
    this.size = this.most.clone().sub(this.least).length();
    this.references = {};
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new THREE.Scene();
    this.layers = {};
    for (const name of ["unloaded", "sections", "loads", "derivatives"]) {
      this.layers[name] = new THREE.Group();
      this.scene.add(this.layers[name]);
    }
    this.addLight();
    this.addCamera();
    this.addGround();
    this.addUnloaded();
    this.parts = facts.layout.map((entry) => this.part(entry));
    this.addDerivatives();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  addLight() {
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#c4ccd4", 3.0));
    const sun = new THREE.DirectionalLight("#ffffff", 2.2);
    sun.position.set(-1, -2, 3);
    this.scene.add(sun);
  }

  addCamera() {
    this.camera = new THREE.PerspectiveCamera(35, 1, this.size / 100, this.size * 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.render());
    this.lookAtAll();
  }

  // The whole scene in view; a planar one is seen across its plane, a little aslant: moments stand on it.
  lookAtAll() {
    const middle = this.least.clone().add(this.most).multiplyScalar(0.5);
    const direction = this.facts.planar ? new THREE.Vector3(0.2, -1, 0.2) : new THREE.Vector3(0.9, -1.5, 0.6);
    const narrow = Math.max(1, 1 / (this.camera.aspect || 1));
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(direction.normalize(), 1.9 * this.size * Math.min(narrow, 1.6));
    this.controls.update();
  }

  // A grid whose cells are a round length, under the scene or, of a planar one, behind it.
  addGround() {
    const rough = this.size / 8;
    const power = 10 ** Math.floor(Math.log10(rough));
    this.cell = power * [1, 2, 5, 10].find((step) => step * power >= rough);
    const count = 2 * Math.ceil((0.8 * this.size) / this.cell);
    const grid = new THREE.GridHelper(count * this.cell, count, "#b9c1c9", "#dde2e7");
    const middle = this.least.clone().add(this.most).multiplyScalar(0.5);
    const round = (value) => Math.round(value / this.cell) * this.cell;
    if (this.facts.planar) {
      // The grid of three.js lies across y, as a planar scene does.
      grid.position.set(round(middle.x), this.most.y + 0.02 * this.size, round(middle.z));
    } else {
      grid.position.set(round(middle.x), round(middle.y), this.least.z - 0.002 * this.size);
      grid.rotateX(Math.PI / 2);
    }
    this.scene.add(grid);
  }

  addUnloaded() {
    for (const points of this.facts.unloaded) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((point) => new THREE.Vector3(...point)));
      const dash = 0.015 * this.size;
      const material = new THREE.LineDashedMaterial({ color: "#8a9199", dashSize: dash, gapSize: dash });
      const line = new THREE.Line(geometry, material);
      line.computeLineDistances();
      this.layers.unloaded.add(line);
    }
    for (const point of this.facts.held) this.addBall(this.scene, point, 0.016, "#333333");
    for (const point of this.facts.targets) this.addBall(this.scene, point, 0.012, this.facts.colours.target);
  }

  addBall(group, point, share, colour) {
    const ball = new THREE.Mesh(new THREE.SphereGeometry(share * this.size, 20, 14), solid(colour));
    ball.position.set(...point);
    group.add(ball);
    return ball;
  }

  // What moves, by the kind of an entry of the layout: a function from its numbers to the picture.
  part(entry) {
    const makers = {
      rod: () => this.rod(entry),
      actuator: () => this.actuator(entry),
      body: () => this.body(entry),
      arrows: () => this.arrows(entry),
    };
    return { entry, update: makers[entry.kind]() };
  }

  rod(entry) {
    const facts = this.facts.rods[entry.name];
    const thinnest = THINNEST * this.size;
    const box = facts.shape === "rectangle";
    const half = (axis, k) => Math.max(facts[axis] ? facts[axis][k] : 1.5 * thinnest, box ? thinnest / 2 : thinnest);
    const corners = box ? [[1, 1], [-1, 1], [-1, -1], [1, -1]] : circle(RING);
    const material = solid(facts.colour, box);
    if (facts.see_through) Object.assign(material, { transparent: true, opacity: 0.5, depthWrite: false });
    const tube = new Tube(entry.columns, corners.length, material);
    this.scene.add(tube.mesh);
    const axes = new Segments(AXES_COLOURS, Math.ceil(entry.columns / AXES_EVERY));
    this.layers.sections.add(axes.lines);
    const clamp = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 28), solid("#444b52"));
    if (!facts.carried) this.scene.add(clamp);
    return (numbers) => {
      for (let k = 0; k < entry.columns; k++) {
        const [centre, x, y] = frame(numbers, 7 * k);
        corners.forEach(([a, b], i) => {
          tube.set(k, i, centre.clone().addScaledVector(x, a * half("x", k)).addScaledVector(y, b * half("y", k)));
        });
        tube.setEnd(k, centre);
        if (k % AXES_EVERY === 0) {
          const length = 0.035 * this.size;
          axes.set(k / AXES_EVERY, 0, centre, centre.clone().addScaledVector(x, length));
          axes.set(k / AXES_EVERY, 1, centre, centre.clone().addScaledVector(y, length));
        }
      }
      tube.finish();
      axes.finish();
      const [base, x, y, z] = frame(numbers, 0);
      const radius = Math.max(2.2 * Math.max(half("x", 0), half("y", 0)), 0.018 * this.size);
      clamp.position.copy(base).addScaledVector(z, -0.006 * this.size);
      clamp.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), z);
      clamp.scale.set(radius, 0.012 * this.size, radius);
    };
  }

  actuator(entry) {
    const facts = this.facts.actuators[entry.name];
    const channel = facts.drawn_as === "channel";
    const radius = (channel ? 0.006 : 0.0022) * this.size;
    const corners = circle(8);
    const material = solid(facts.colour);
    if (channel) Object.assign(material, { transparent: true, opacity: 0.8 });
    const tube = new Tube(entry.columns, corners.length, material);
    this.scene.add(tube.mesh);
    const point = (numbers, k) => new THREE.Vector3(numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]);
    return (numbers) => {
      let across = null;
      for (let k = 0; k < entry.columns; k++) {
        const centre = point(numbers, k);
        const before = point(numbers, Math.max(k - 1, 0));
        const tangent = point(numbers, Math.min(k + 1, entry.columns - 1)).sub(before).normalize();
        if (!across) across = leastAlong(tangent);
        // The last section's direction, made perpendicular to this one's tangent: the tube does not twist.
        across = across.addScaledVector(tangent, -across.dot(tangent)).normalize();
        const other = tangent.clone().cross(across);
        corners.forEach(([a, b], i) => {
          tube.set(k, i, centre.clone().addScaledVector(across, a * radius).addScaledVector(other, b * radius));
        });
        tube.setEnd(k, centre);
      }
      tube.finish();
    };
  }

  body(entry) {
    const facts = this.facts.bodies[entry.name];
    const group = new THREE.Group();
    const colour = this.facts.colours.body;
    const corners = facts.corners.map((corner) => new THREE.Vector3(...corner));
    if (corners.length > 2) {
      const points = corners.slice(1, -1).flatMap((corner, i) => [corners[0], corner, corners[i + 2]]);
      const geometry = new THREE.BufferGeometry().setFromPoints(points);
      geometry.computeVertexNormals();
      const material = solid(colour);
      Object.assign(material, { side: THREE.DoubleSide, transparent: true, opacity: 0.45 });
      group.add(new THREE.Mesh(geometry, material));
    }
    corners.forEach((corner, i) => {
      const next = corners[(i + 1) % corners.length];
      group.add(bar(corner, next, 0.004 * this.size, solid(colour)));
    });
    for (const joint of facts.joints) this.addBall(group, joint, 0.009, "#59616a");
    this.scene.add(group);
    return (numbers) => {
      const [x, y, z, qw, qx, qy, qz] = numbers;
      group.position.set(x, y, z);
      group.quaternion.set(qx, qy, qz, qw);
    };
  }

  arrows(entry) {
    const colour = this.facts.colours[entry.sort];
    const thickness = entry.sort === "line" ? 0.6 : 1.2;
    const arrows = Array.from({ length: entry.columns }, () => new Arrow(colour, entry.sort === "moment"));
    for (const arrow of arrows) this.layers.loads.add(arrow.group);
    return (numbers) => {
      arrows.forEach((arrow, k) => {
        const start = new THREE.Vector3(...numbers.subarray(6 * k, 6 * k + 3));
        const vector = new THREE.Vector3(...numbers.subarray(6 * k + 3, 6 * k + 6));
        arrow.point(start, vector.multiplyScalar(this.arrowScale(entry.sort)), thickness * 0.0035 * this.size);
      });
    };
  }

  // Metres for the unit of a sort: what the largest arrow of the first picture has by its style.
  arrowScale(sort) {
    const reference = this.references[sort];
    return reference > 0 ? (this.facts.arrow_lengths[sort] * 0.75 * this.size) / reference : 0;
  }

  // The first arrows of a sort set its scale; it shrinks where they grow far beyond.
  measureArrows(drawn) {
    for (const entry of this.facts.layout.filter((entry) => entry.kind === "arrows")) {
      for (let k = 0; k < entry.columns; k++) {
        const vector = drawn.subarray(entry.first + 6 * k + 3, entry.first + 6 * k + 6);
        const reference = this.references[entry.sort] || 0;
        if (!reference || Math.hypot(...vector) > 2.5 * reference) this.references[entry.sort] = Math.hypot(...vector);
      }
    }
  }

  // Draw the numbers that the library gives; faint where they are no equilibrium at the full load.
  draw(drawn, found = true) {
    this.measureArrows(drawn);
    for (const { entry, update } of this.parts) {
      update(drawn.subarray(entry.first, entry.first + entry.rows * entry.columns));
    }
    this.canvas.classList.toggle("faint", !found);
    this.render();
  }

  addDerivatives() {
    this.derivativeArrows = this.facts.sliders.map(() => new Arrow(DERIVATIVES));
    for (const arrow of this.derivativeArrows) this.layers.derivatives.add(arrow.group);
    const material = solid(DERIVATIVES);
    Object.assign(material, { transparent: true, opacity: 0.18, depthWrite: false });
    this.ellipsoid = new THREE.Mesh(new THREE.SphereGeometry(1, 40, 24), material);
    this.ellipsoid.matrixAutoUpdate = false;
    this.layers.derivatives.add(this.ellipsoid);
    this.layers.derivatives.visible = false;
  }

  // How a point moves with each input, from its derivatives (3 for each), and where all of them together can take it:
  // the image of the ball of inputs, each over a tenth of its slider.
  drawDerivatives(position, columns) {
    this.layers.derivatives.visible = columns !== null;
    if (columns === null) return this.render();
    const moves = columns.map((column, i) => {
      const { least, most } = this.facts.sliders[i];
      return column.map((value) => (value * (most - least)) / 10);
    });
    const largest = Math.max(...moves.map((move) => Math.hypot(...move)), 0);
    // A point that is held moves by rounding alone.
    const scale = largest > 1e-9 * this.size ? (0.22 * this.size) / largest : 0;
    const start = new THREE.Vector3(...position);
    const scaled = moves.map((move) => move.map((value) => value * scale));
    scaled.forEach((move, i) => {
      this.derivativeArrows[i].point(start, new THREE.Vector3(...move), 0.003 * this.size);
    });
    const covariance = [0, 1, 2].map((i) => [0, 1, 2].map((j) => scaled.reduce((sum, move) => sum + move[i] * move[j], 0)));
    const { values, vectors } = eigen(covariance);
    const radii = values.map((value) => Math.max(Math.sqrt(Math.max(value, 0)), 1e-4 * this.size));
    const rows = [0, 1, 2].map((i) => [0, 1, 2].map((j) => vectors[i][j] * radii[j]));
    this.ellipsoid.matrix.set(...rows[0], position[0], ...rows[1], position[1], ...rows[2], position[2], 0, 0, 0, 1);
    this.ellipsoid.matrixWorldNeedsUpdate = true;
    this.render();
  }

  // Where the arrows of the derivatives end on the screen, px, the longest first; short ones are left out.
  derivativeEnds() {
    const shown = this.derivativeArrows.map((arrow, i) => ({ arrow, i })).filter(({ arrow }) => arrow.group.visible);
    shown.sort((one, other) => other.arrow.length - one.arrow.length);
    return shown.map(({ arrow, i }) => ({ i, end: this.onScreen(arrow.end) }));
  }

  // A point of the world on the picture, px.
  onScreen(point) {
    const { clientWidth, clientHeight } = this.canvas;
    const projected = point.clone().project(this.camera);
    return { x: ((projected.x + 1) * clientWidth) / 2, y: ((1 - projected.y) * clientHeight) / 2 };
  }

  show(layer, visible) {
    this.layers[layer].visible = visible;
    this.render();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    if (!this.placed) this.lookAtAll();
    this.placed = true;
    this.render();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }
}

// A surface swept by sections of the same number of corners, closed at both ends.
class Tube {
  constructor(sections, corners, material) {
    this.sections = sections;
    this.corners = corners;
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * (sections * corners + 2)), 3);
    const index = [];
    for (let k = 0; k + 1 < sections; k++) {
      for (let i = 0; i < corners; i++) {
        const next = (i + 1) % corners;
        const [a, b, c, d] = [k * corners + i, k * corners + next, (k + 1) * corners + i, (k + 1) * corners + next];
        index.push(a, b, d, a, d, c);
      }
    }
    const last = (sections - 1) * corners;
    for (let i = 0; i < corners; i++) {
      const next = (i + 1) % corners;
      index.push(sections * corners, next, i, sections * corners + 1, last + i, last + next);
    }
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute("position", this.positions);
    this.geometry.setIndex(index);
    this.mesh = new THREE.Mesh(this.geometry, material);
    this.mesh.frustumCulled = false;
  }

  set(section, corner, point) {
    this.positions.setXYZ(section * this.corners + corner, point.x, point.y, point.z);
  }

  // The middle of a section, where it is the first or the last.
  setEnd(section, point) {
    if (section === 0) this.positions.setXYZ(this.sections * this.corners, point.x, point.y, point.z);
    if (section === this.sections - 1) this.positions.setXYZ(this.sections * this.corners + 1, point.x, point.y, point.z);
  }

  finish() {
    this.positions.needsUpdate = true;
    this.geometry.computeVertexNormals();
  }
}

// Short lines, a few of each colour at each place.
class Segments {
  constructor(colours, places) {
    this.colours = colours;
    this.positions = new THREE.BufferAttribute(new Float32Array(6 * colours.length * places), 3);
    const geometry = new THREE.BufferGeometry().setAttribute("position", this.positions);
    const shades = [];
    for (let k = 0; k < places; k++) {
      for (const colour of colours) shades.push(...new THREE.Color(colour).toArray(), ...new THREE.Color(colour).toArray());
    }
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(shades), 3));
    this.lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true }));
    this.lines.frustumCulled = false;
  }

  set(place, colour, from, to) {
    const first = 2 * (place * this.colours.length + colour);
    this.positions.setXYZ(first, from.x, from.y, from.z);
    this.positions.setXYZ(first + 1, to.x, to.y, to.z);
  }

  finish() {
    this.positions.needsUpdate = true;
  }
}

// A shaft with a head, or with two, as a moment has.
class Arrow {
  constructor(colour, twoHeads = false) {
    this.group = new THREE.Group();
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0), solid(colour));
    const cone = new THREE.ConeGeometry(1, 1, 18).translate(0, -0.5, 0);
    this.heads = Array.from({ length: twoHeads ? 2 : 1 }, () => new THREE.Mesh(cone, this.shaft.material));
    this.group.add(this.shaft, ...this.heads);
  }

  point(start, vector, thickness) {
    const length = vector.length();
    this.length = length;
    this.end = start.clone().add(vector);
    this.group.visible = length > 3 * thickness;
    if (!this.group.visible) return;
    this.group.position.copy(start);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector.clone().normalize());
    const head = Math.min(9 * thickness, 0.45 * length);
    this.shaft.scale.set(thickness, length - head / 2, thickness);
    this.heads.forEach((mesh, i) => {
      mesh.scale.set(0.36 * head, head, 0.36 * head);
      mesh.position.y = length - 0.7 * i * head;
    });
  }
}

function solid(colour, flatShading = false) {
  return new THREE.MeshStandardMaterial({ color: colour, roughness: 0.6, metalness: 0.05, flatShading, side: THREE.DoubleSide });
}

// Corners of a polygon that stands for a circle of radius 1.
function circle(corners) {
  const angles = Array.from({ length: corners }, (_, i) => (2 * Math.PI * i) / corners);
  return angles.map((angle) => [Math.cos(angle), Math.sin(angle)]);
}

// A round bar between two points.
function bar(from, to, radius, material) {
  const along = to.clone().sub(from);
  const mesh = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, along.length(), 10), material);
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
  return mesh;
}

// Position and axes x, y, z of a section from position and quaternion w, x, y, z.
function frame(numbers, first) {
  const [px, py, pz, w, x, y, z] = numbers.subarray(first, first + 7);
  const turn = new THREE.Quaternion(x, y, z, w);
  const axis = (a, b, c) => new THREE.Vector3(a, b, c).applyQuaternion(turn);
  return [new THREE.Vector3(px, py, pz), axis(1, 0, 0), axis(0, 1, 0), axis(0, 0, 1)];
}

// The axis of the world that a direction has least of.
function leastAlong(direction) {
  const sizes = direction.toArray().map(Math.abs);
  const axis = new THREE.Vector3();
  axis.setComponent(sizes.indexOf(Math.min(...sizes)), 1);
  return axis;
}
