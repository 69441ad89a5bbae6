// What is drawn: rods as swept sections, actuators, bodies, arrows, derivatives. World axes, z up, metres.

const RING = 14; // Corners of a round section.
const THIN_RING = 8; // Of one that is a few pixels wide: a processor without a graphics card pays for each triangle.
const THREAD_RING = 5; // Of a tendon.
const THIN = 0.01; // Half width of such a section, relative to the scene.
const AXES_EVERY = 6; // Sections whose axes are drawn.
const AXES_COLOURS = ["#cc3311", "#228833"];
const DERIVATIVES = "#0077bb";
const CONTACTS = "#000000";
const CONTACT_BALL = 0.009; // Radius of a mark of contact, relative to the scene.
const ARROW = 0.0042; // Radius of the shaft of an arrow, relative to the scene.
const THINNEST = 0.004; // Least half width of what is drawn, relative to the scene.

class Scenery {
  constructor(canvas, facts) {
    this.canvas = canvas;
    this.facts = facts;
    this.least = new THREE.Vector3(...facts.least);
    this.most = new THREE.Vector3(...facts.most);
    this.size = this.most.clone().sub(this.least).length();
    this.references = {};
    this.scene = new THREE.Scene();
    this.layers = {};
    for (const name of ["unloaded", "sections", "loads", "obstacles", "contacts", "derivatives"]) {
      this.layers[name] = new THREE.Group();
      this.scene.add(this.layers[name]);
    }
    this.addLight();
    this.addCamera();
    this.addGround();
    this.addUnloaded();
    this.addObstacles();
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
    this.painter = new Painter(this.canvas, this.scene, this.camera);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.painter.paint());
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

  // Print the picture on a sheet, a canvas of its size, over the ground that the page has.
  printOn(sheet) {
    this.painter.paintStill();
    const { width, height } = this.canvas;
    if (sheet.width !== width || sheet.height !== height) Object.assign(sheet, { width, height });
    const pen = sheet.getContext("2d");
    pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--light");
    pen.fillRect(0, 0, width, height);
    pen.drawImage(this.canvas, 0, 0);
    return sheet;
  }

  save() {
    this.printOn(document.createElement("canvas")).toBlob((content) => offer(content, "png"));
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

  // Obstacles of the world, or those that move with a body.
  addObstacles(group = this.layers.obstacles, on = null) {
    for (const { net, body } of this.facts.obstacles) {
      if (body !== on) continue;
      const material = solid(this.facts.colours.obstacle);
      // Seen through from both sides: a lumen has the robot inside.
      Object.assign(material, { transparent: true, opacity: 0.35, depthWrite: false });
      group.add(new THREE.Mesh(netGeometry(net), material));
    }
  }

  // Where rods touch obstacles: points or stretches of centre lines, and the resultant on the rod.
  drawContacts(contacts) {
    const group = this.layers.contacts;
    for (const { geometry, material } of group.children) {
      geometry.dispose();
      material.dispose();
    }
    group.clear();
    if (!contacts.length) return;
    const arrows = new Arrows(this.facts.colours.point, contacts.length);
    group.add(arrows.mesh);
    contacts.forEach(({ points, force }, i) => {
      const line = points.map((point) => new THREE.Vector3(...point));
      const ends = line.length > 1 ? [line[0], line[line.length - 1]] : line;
      for (const end of ends) this.addBall(group, end.toArray(), CONTACT_BALL, CONTACTS);
      line.slice(1).forEach((point, k) => group.add(bar(line[k], point, 0.8 * CONTACT_BALL * this.size, solid(CONTACTS))));
      const middle = line[Math.floor(line.length / 2)];
      arrows.point(i, middle, new THREE.Vector3(...force).multiplyScalar(this.arrowScale("point")), ARROW * this.size);
    });
    arrows.finish();
  }

  addBall(group, point, share, colour) {
    const ball = new THREE.Mesh(new THREE.SphereGeometry(share * this.size, 12, 8), solid(colour));
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
    const widest = Math.max(...Array.from({ length: entry.columns }, (_, k) => half("x", k)));
    const round = circle(widest < THIN * this.size ? THIN_RING : RING);
    const corners = box ? [[1, 1], [-1, 1], [-1, -1], [1, -1]] : round;
    const material = solid(facts.colour, box);
    if (facts.see_through) Object.assign(material, { transparent: true, opacity: 0.5, depthWrite: false });
    const tube = new Tube(entry.columns, corners.length, material);
    this.scene.add(tube.mesh);
    const axes = new Segments(AXES_COLOURS, Math.ceil(entry.columns / AXES_EVERY));
    this.layers.sections.add(axes.lines);
    const clamp = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 20), solid("#444b52"));
    if (!facts.carried) this.scene.add(clamp);
    const disks = facts.disks.map(([at, radius, thickness]) => {
      const height = Math.max(thickness, thinnest / 2);
      const disk = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, height, 40), solid(this.facts.colours.body));
      // The axis of a cylinder is its y; that of a section is z.
      disk.geometry.rotateX(Math.PI / 2);
      Object.assign(disk.material, { transparent: true, opacity: 0.6 });
      this.scene.add(disk);
      return { disk, at };
    });
    return (numbers) => {
      for (const { disk, at } of disks) {
        const place = at * (entry.columns - 1);
        const k = Math.min(Math.floor(place), entry.columns - 2);
        const [before, ...axes] = frame(numbers, 7 * Math.round(place));
        disk.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(...axes));
        disk.position.copy(frame(numbers, 7 * k)[0]).lerp(frame(numbers, 7 * (k + 1))[0], place - k);
      }
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
    const corners = circle(channel ? THIN_RING : THREAD_RING);
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
    // A group of their own, so that they are hidden with the other obstacles.
    const fixed = new THREE.Group();
    this.addObstacles(fixed, entry.name);
    this.layers.obstacles.add(fixed);
    return (numbers) => {
      const [x, y, z, qw, qx, qy, qz] = numbers;
      for (const moved of [group, fixed]) {
        moved.position.set(x, y, z);
        moved.quaternion.set(qx, qy, qz, qw);
      }
    };
  }

  arrows(entry) {
    const colour = this.facts.colours[entry.sort];
    const thickness = entry.sort === "line" ? ARROW / 2 : ARROW;
    const arrows = new Arrows(colour, entry.columns, entry.sort === "moment");
    this.layers.loads.add(arrows.mesh);
    return (numbers) => {
      for (let k = 0; k < entry.columns; k++) {
        const start = new THREE.Vector3(...numbers.subarray(6 * k, 6 * k + 3));
        const vector = new THREE.Vector3(...numbers.subarray(6 * k + 3, 6 * k + 6));
        arrows.point(k, start, vector.multiplyScalar(this.arrowScale(entry.sort)), thickness * this.size);
      }
      arrows.finish();
    };
  }

  // Metres for the unit of a sort: what the largest arrow of the first picture has by its style.
  arrowScale(sort) {
    const reference = this.references[sort];
    return reference > 0 ? (this.facts.arrow_lengths[sort] * 0.75 * this.size) / reference : 0;
  }

  // The first arrows of a sort set its scale; it shrinks where they grow far beyond.
  measureArrows(drawn, contacts) {
    for (const entry of this.facts.layout.filter((entry) => entry.kind === "arrows")) {
      for (let k = 0; k < entry.columns; k++) {
        this.measureArrow(entry.sort, drawn.subarray(entry.first + 6 * k + 3, entry.first + 6 * k + 6));
      }
    }
    for (const { force } of contacts) this.measureArrow("point", force);
  }

  measureArrow(sort, vector) {
    const reference = this.references[sort] || 0;
    const length = Math.hypot(...vector);
    if (!reference || length > 2.5 * reference) this.references[sort] = length;
  }

  // Draw the numbers that the library gives; faint where they are no equilibrium at the full load.
  draw(drawn, found = true, contacts = []) {
    this.measureArrows(drawn, contacts);
    this.drawContacts(contacts);
    for (const { entry, update } of this.parts) {
      update(drawn.subarray(entry.first, entry.first + entry.rows * entry.columns));
    }
    this.canvas.parentElement.classList.toggle("faint", !found);
    this.painter.paint();
  }

  addDerivatives() {
    this.derivativeArrows = new Arrows(DERIVATIVES, this.facts.sliders.length);
    this.layers.derivatives.add(this.derivativeArrows.mesh);
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
    if (columns === null) return this.painter.paint();
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
      this.derivativeArrows.point(i, start, new THREE.Vector3(...move), 0.003 * this.size);
    });
    this.derivativeArrows.finish();
    const covariance = [0, 1, 2].map((i) => [0, 1, 2].map((j) => scaled.reduce((sum, move) => sum + move[i] * move[j], 0)));
    const { values, vectors } = eigen(covariance);
    const radii = values.map((value) => Math.max(Math.sqrt(Math.max(value, 0)), 1e-4 * this.size));
    const rows = [0, 1, 2].map((i) => [0, 1, 2].map((j) => vectors[i][j] * radii[j]));
    this.ellipsoid.matrix.set(...rows[0], position[0], ...rows[1], position[1], ...rows[2], position[2], 0, 0, 0, 1);
    this.ellipsoid.matrixWorldNeedsUpdate = true;
    this.painter.paint();
  }

  // Where the arrows of the derivatives end on the screen, px, the longest first; short ones are left out.
  derivativeEnds() {
    const { lengths, ends } = this.derivativeArrows;
    const shown = [...lengths.keys()].filter((i) => lengths[i] > 0);
    shown.sort((one, other) => lengths[other] - lengths[one]);
    return shown.map((i) => ({ i, end: this.onScreen(ends[i]) }));
  }

  // A point of the world on the picture, px.
  onScreen(point) {
    const { clientWidth, clientHeight } = this.canvas;
    const projected = point.clone().project(this.camera);
    return { x: ((projected.x + 1) * clientWidth) / 2, y: ((1 - projected.y) * clientHeight) / 2 };
  }

  show(layer, visible) {
    this.layers[layer].visible = visible;
    this.painter.paint();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    this.camera.aspect = clientWidth / Math.max(clientHeight, 1);
    this.camera.updateProjectionMatrix();
    if (!this.placed) this.lookAtAll();
    this.placed = true;
    // Names and the ring stand elsewhere now.
    this.controls.dispatchEvent({ type: "change" });
    // The picture's size has changed: what was painted is gone.
    this.painter.paintStill();
  }
}

// Hand a file to the browser, to be saved under the beginning of the scene's title.
function offer(content, suffix) {
  const words = document.title.toLowerCase().split(/[^\p{L}\p{N}]+/u).filter((word) => word);
  const name = `${words.slice(0, 6).join("_") || "robot"}.${suffix}`;
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(content), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
