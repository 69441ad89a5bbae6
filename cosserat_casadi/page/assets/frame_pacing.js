// Paints a scene: as well as can be at rest, and as finely as there is time for while something moves.

const IN_TIME = 28; // Milliseconds from one picture to the next: 30 a second, with some to spare.
const STILL = 150; // Milliseconds after a picture from which on nothing moves any more.
const LATE = 3; // Pictures that are late before the next ones are coarser.
const EARLY = 60; // Pictures in time before finer ones are tried; twice as many after a trial that failed.

// How a picture is painted while something moves, from the finest: its pixels over those of the screen, along each axis.
// Smooth edges are most of the work of a processor without a graphics card.
const QUALITIES = [
  { smooth: true, share: 1 },
  { smooth: false, share: 1 },
  { smooth: false, share: 0.7 },
  { smooth: false, share: 0.5 },
];

// The quality that there is time for, learnt from how long pictures take.
class Pace {
  constructor() {
    this.quality = 0;
    this.late = 0;
    this.early = 0;
    this.patience = EARLY;
    this.trial = false;
  }

  // A picture took so many milliseconds.
  took(milliseconds) {
    if (milliseconds > IN_TIME) {
      this.late++;
      this.early = 0;
    } else {
      this.late = Math.max(this.late - 1, 0);
      this.early++;
    }
    if (this.late >= LATE) this.coarser();
    if (this.early >= this.patience) this.finer();
  }

  coarser() {
    if (this.trial) this.patience *= 2;
    this.trial = false;
    this.turnTo(this.quality + 1);
  }

  finer() {
    this.trial = this.quality > 0;
    this.turnTo(this.quality - 1);
  }

  turnTo(quality) {
    this.quality = Math.min(Math.max(quality, 0), QUALITIES.length - 1);
    this.late = 0;
    this.early = 0;
  }
}

class Painter {
  constructor(canvas, scene, camera) {
    this.canvas = canvas;
    this.scene = scene;
    this.camera = camera;
    this.pace = new Pace();
    this.shown = QUALITIES[0];
    this.smooth = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.rough = null;
  }

  // Something has moved: painted with the browser's next picture, however many things have.
  paint() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.paintMoving();
    });
  }

  paintMoving() {
    const began = performance.now();
    this.show(QUALITIES[this.pace.quality]);
    // The browser's next picture waits for what is painted now, and not for what is solved.
    requestAnimationFrame(() => this.pace.took(performance.now() - began));
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.shown === QUALITIES[0] || this.paintStill(), STILL);
  }

  paintStill() {
    this.show(QUALITIES[0]);
  }

  show(quality) {
    if (!quality.smooth && !this.rough) this.addRough();
    this.shown = quality;
    const renderer = quality.smooth ? this.smooth : this.rough;
    this.fit(renderer, quality.share);
    renderer.render(this.scene, this.camera);
    this.canvas.parentElement.classList.toggle("rough", !quality.smooth);
  }

  // Made where it is needed alone: most machines have a graphics card.
  addRough() {
    const canvas = document.createElement("canvas");
    canvas.id = "rough";
    canvas.setAttribute("aria-hidden", "true");
    this.canvas.after(canvas);
    this.rough = new THREE.WebGLRenderer({ canvas, antialias: false, alpha: true });
  }

  // As many pixels as the window has, or a share of them.
  fit(renderer, share) {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    const ratio = share * Math.min(window.devicePixelRatio, 2);
    const { width, height } = renderer.domElement;
    if (width === Math.floor(clientWidth * ratio) && height === Math.floor(clientHeight * ratio)) return;
    renderer.setPixelRatio(ratio);
    renderer.setSize(clientWidth, clientHeight, false);
  }
}
