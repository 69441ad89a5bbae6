// Shapes that pictures are made of: swept surfaces, nets, short lines, arrows, bars.

const SAME = 1e-9; // Metres between two points that are one, but for rounding.

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

// Arrows of one colour in one mesh: each a shaft with a head, or with two, as moments have.
class Arrows {
  constructor(colour, count, twoHeads = false) {
    const shaft = new THREE.CylinderGeometry(1, 1, 1, 6, 1, true).translate(0, 0.5, 0);
    const head = new THREE.ConeGeometry(0.36, 1, 10).translate(0, -0.5, 0);
    this.parts = twoHeads ? [shaft, head, head] : [shaft, head];
    this.vertices = this.parts.reduce((sum, part) => sum + part.attributes.position.count, 0);
    this.positions = new THREE.BufferAttribute(new Float32Array(3 * this.vertices * count), 3);
    this.normals = new THREE.BufferAttribute(new Float32Array(3 * this.vertices * count), 3);
    const index = [];
    for (let k = 0; k < count; k++) {
      let first = k * this.vertices;
      for (const part of this.parts) {
        for (const vertex of part.index.array) index.push(first + vertex);
        first += part.attributes.position.count;
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions).setAttribute("normal", this.normals).setIndex(index);
    this.mesh = new THREE.Mesh(geometry, solid(colour));
    this.mesh.frustumCulled = false;
    // Of those that are long enough to be seen, 0 of the others.
    this.lengths = new Float64Array(count);
    this.ends = Array.from({ length: count }, () => new THREE.Vector3());
  }

  point(k, start, vector, thickness) {
    const length = vector.length() > 3 * thickness ? vector.length() : 0;
    const turn = new THREE.Quaternion();
    if (length) turn.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector.clone().divideScalar(length));
    this.lengths[k] = length;
    this.ends[k].copy(start).add(vector);
    const head = Math.min(9 * thickness, 0.45 * length);
    let vertex = k * this.vertices;
    this.parts.forEach((part, i) => {
      const [across, along] = i ? [head, head] : [length && thickness, length - head / 2];
      const up = i ? length - 0.7 * (i - 1) * head : 0;
      const { position, normal } = part.attributes;
      for (let v = 0; v < position.count; v++, vertex++) {
        const point = new THREE.Vector3(across * position.getX(v), up + along * position.getY(v), across * position.getZ(v));
        point.applyQuaternion(turn).add(start);
        this.positions.setXYZ(vertex, point.x, point.y, point.z);
        point.fromBufferAttribute(normal, v).applyQuaternion(turn);
        this.normals.setXYZ(vertex, point.x, point.y, point.z);
      }
    });
  }

  finish() {
    this.positions.needsUpdate = true;
    this.normals.needsUpdate = true;
  }
}

// A surface through rows of points; rows that end where they begin are closed.
function netGeometry(net) {
  const columns = net[0].length;
  const isClosed = net.every((row) => row[0].every((value, axis) => Math.abs(value - row[columns - 1][axis]) < SAME));
  const count = isClosed ? columns - 1 : columns;
  const index = [];
  for (let k = 0; k + 1 < net.length; k++) {
    for (let i = 0; i + 1 < columns; i++) {
      const next = (i + 1) % count;
      const [a, b, c, d] = [k * count + i, k * count + next, (k + 1) * count + i, (k + 1) * count + next];
      index.push(a, b, d, a, d, c);
    }
  }
  const positions = new Float32Array(net.flatMap((row) => row.slice(0, count)).flat());
  const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}

function solid(colour, flatShading = false) {
  return new THREE.MeshLambertMaterial({ color: colour, flatShading, side: THREE.DoubleSide });
}

// Corners of a polygon that stands for a circle of radius 1.
function circle(corners) {
  const angles = Array.from({ length: corners }, (_, i) => (2 * Math.PI * i) / corners);
  return angles.map((angle) => [Math.cos(angle), Math.sin(angle)]);
}

// A round bar between two points.
function bar(from, to, radius, material) {
  const along = to.clone().sub(from);
  const mesh = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, along.length(), 8), material);
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
