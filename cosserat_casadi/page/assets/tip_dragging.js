// The chosen tip or body under the hand: dragged, it is led by the derivatives to where the pointer is.

const STEP = 0.25; // Largest change of an input in one step, over half its slider.
const DAMPING = 1e-4; // Of the least squares, over the largest eigenvalue: what is hardly reachable is hardly tried.
const MOST_DAMPING = 1e2; // Beyond it no step brings the tip nearer.

class Hand {
  constructor(panel) {
    this.panel = panel;
    this.scenery = panel.scenery;
    this.mark = element("div", document.getElementById("picture"));
    this.mark.id = "hand";
    this.mark.title = "Drag me: the inputs follow";
    this.wanted = null;
    this.following = null;
    this.mark.onpointerdown = (event) => this.take(event);
    this.mark.onpointermove = (event) => this.mark.hasPointerCapture(event.pointerId) && this.lead(this.under(event));
    this.mark.onpointerup = () => this.letGo();
    this.mark.onpointercancel = () => this.letGo();
    this.scenery.controls.addEventListener("change", () => this.place());
    panel.listeners.push(() => this.place());
    panel.interrupted.push(() => (this.wanted = null));
    this.place();
  }

  get position() {
    return new THREE.Vector3(...this.panel.pose(this.panel.point).position);
  }

  place() {
    const { x, y } = this.scenery.onScreen(this.position);
    this.mark.style.transform = `translate(${x}px, ${y}px)`;
  }

  take(event) {
    event.preventDefault();
    this.mark.setPointerCapture(event.pointerId);
    this.last = null;
  }

  // The ray of sight through the pointer: how far away the tip is on it is left to the robot.
  under(event) {
    const box = this.scenery.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    const { camera } = this.scenery;
    return new THREE.Ray(camera.position.clone(), new THREE.Vector3(x, y, 0.5).unproject(camera).sub(camera.position).normalize());
  }

  // Go on towards a ray until the tip is on it, or no step brings the tip nearer.
  lead(ray) {
    this.wanted = ray;
    this.last = ray;
    if (!this.following) this.following = this.follow().finally(() => (this.following = null));
  }

  async follow() {
    // Levenberg and Marquardt: a step that leads away is taken back, and tried again with more damping.
    let damping = DAMPING;
    let aim = this.wanted;
    while (this.wanted) {
      if (aim !== this.wanted) damping = DAMPING;
      aim = this.wanted;
      const before = aim.distanceToPoint(this.position);
      const inputs = this.panel.inputs;
      await this.step(aim, damping);
      if (!this.wanted) return;
      const nearer = aim.distanceToPoint(this.position) < before;
      if (!nearer) await this.panel.solve(inputs);
      damping = nearer ? Math.max(damping / 10, DAMPING) : damping * 10;
      const arrived = aim.distanceToPoint(this.position) < 1e-5 * this.scenery.size;
      if ((arrived || damping > MOST_DAMPING) && aim === this.wanted) this.wanted = null;
    }
  }

  async step(ray, damping) {
    const { facts } = this.panel;
    const all = await this.panel.robot.derivatives();
    if (!all || !this.wanted) return;
    const inputs = Float64Array.from(this.panel.inputs);
    const columns = facts.hand.map((i) => {
      const first = 7 * (facts.sliders.length * this.panel.point + i);
      const half = (facts.sliders[i].most - facts.sliders[i].least) / 2;
      const column = new THREE.Vector3(...all.subarray(first, first + 3)).multiplyScalar(half);
      return column.addScaledVector(ray.direction, -column.dot(ray.direction)).toArray();
    });
    const gap = ray.closestPointToPoint(this.position, new THREE.Vector3()).sub(this.position).toArray();
    const changes = leastChange(columns, gap, damping, (k, change) => {
      const { least, most } = facts.sliders[facts.hand[k]];
      const value = inputs[facts.hand[k]];
      return change > 0 ? value >= most : value <= least;
    });
    const largest = Math.max(...changes.map(Math.abs), 0);
    const share = Math.min(1, STEP / largest);
    facts.hand.forEach((i, k) => {
      const { least, most } = facts.sliders[i];
      inputs[i] = Math.min(Math.max(inputs[i] + (share * changes[k] * (most - least)) / 2, least), most);
    });
    if (largest > 0) await this.panel.solve(inputs);
  }

  // A program behind the page finds the inputs once more, as `inverse` does, and says whether the point is met.
  async letGo() {
    if (!this.last || !this.panel.robot.reach) return;
    const point = this.last.closestPointToPoint(this.position, new THREE.Vector3());
    this.last = null;
    this.wanted = null;
    // A step that is under way would otherwise have the last word.
    await this.following;
    this.panel.say("… Finding the inputs", "for the point where you let go.");
    const answer = await this.panel.robot.reach(this.panel.facts.poses[this.panel.point], point.toArray());
    this.panel.receive(answer);
  }
}

// Changes u of least size with Σ u_k column_k near a gap (damped least squares), without those that are at their ends.
function leastChange(columns, gap, damping, atEnd) {
  const free = new Set(columns.keys());
  for (;;) {
    const axes = [0, 1, 2];
    const chosen = [...free];
    const gram = axes.map((i) => axes.map((j) => chosen.reduce((sum, k) => sum + columns[k][i] * columns[k][j], 0)));
    const { values, vectors } = eigen(gram);
    const added = damping * Math.max(...values);
    const weights = new Float64Array(3);
    axes.forEach((axis) => {
      const along = axes.reduce((sum, i) => sum + vectors[i][axis] * gap[i], 0);
      if (added > 0) axes.forEach((i) => (weights[i] += (vectors[i][axis] * along) / (values[axis] + added)));
    });
    const changes = columns.map((column, k) => (free.has(k) ? column.reduce((sum, value, i) => sum + value * weights[i], 0) : 0));
    const blocked = chosen.filter((k) => changes[k] !== 0 && atEnd(k, changes[k]));
    if (!blocked.length) return changes;
    blocked.forEach((k) => free.delete(k));
  }
}
