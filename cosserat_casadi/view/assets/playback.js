// Motions and modes, played with a time bar.

const PERIOD = 1.6; // Seconds that one period of a mode takes on the screen.
const FILM_RATE = 30; // Pictures a second of a film in a file.
const FIRST_PICTURES = 100; // Milliseconds after which the first pictures of a film are asked for.
const SPEEDS = [1, 0.5, 0.1, 0.02];

class Theatre {
  constructor(panel, facts) {
    this.panel = panel;
    this.film = null;
    const field = element("fieldset", document.getElementById("extras"));
    element("legend", field).textContent = "In motion";
    this.button(field, "Vibrations here", () => this.showModes());
    if (facts.motion) this.button(field, "Motion of the scene", () => this.showMotion());
    this.choice = element("select", field);
    this.choice.setAttribute("aria-label", "Mode");
    this.choice.hidden = true;
    this.choice.onchange = () => this.play(this.modes[Number(this.choice.value)]);
    this.words = element("p", field);
    this.words.setAttribute("role", "status");
    this.buildTransport();
    panel.listeners.push(() => this.close());
  }

  button(parent, words, act) {
    const button = element("button", parent);
    Object.assign(button, { type: "button", textContent: words, onclick: act });
    return button;
  }

  buildTransport() {
    this.transport = document.getElementById("transport");
    this.toggle = this.button(this.transport, "❚❚", () => this.pause(!this.paused));
    this.toggle.setAttribute("aria-label", "Play or pause");
    this.bar = element("input", this.transport);
    Object.assign(this.bar, { type: "range", min: 0, max: 1, step: "any" });
    this.bar.setAttribute("aria-label", "Time");
    this.bar.oninput = () => {
      this.pause(true);
      this.seek(this.bar.valueAsNumber);
    };
    this.clock = element("output", this.transport);
    this.speed = element("select", this.transport);
    this.speed.setAttribute("aria-label", "Speed");
    for (const speed of SPEEDS) this.speed.add(new Option(`× ${speed}`, speed));
    this.button(this.transport, "● Film", () => this.record());
    this.button(this.transport, "✕", () => this.close()).setAttribute("aria-label", "Back to the equilibrium");
  }

  async showModes() {
    this.words.textContent = "Finding the modes …";
    const answer = await this.panel.robot.modes();
    this.words.textContent = answer.refused || answer.text;
    if (answer.refused || !answer.modes.length) return;
    this.modes = answer.modes.map((mode) => ({ ...unpacked(mode.frames, this.size), duration: PERIOD, loop: true, words: mode.words }));
    this.choice.replaceChildren(...this.modes.map((mode, i) => new Option(`${i + 1}: ${mode.words}`, i)));
    this.play(this.modes[0]);
    this.choice.hidden = false;
  }

  async showMotion() {
    this.words.textContent = "Computing the motion, from the scene's own inputs …";
    const answer = await this.panel.robot.motion();
    this.words.textContent = answer.refused || answer.text;
    if (answer.refused || !answer.times.length) return;
    const { times } = answer;
    this.choice.hidden = true;
    this.play({ ...unpacked(answer.frames, this.size), start: times[0], duration: times[times.length - 1] - times[0], loop: true });
  }

  // Numbers of one picture.
  get size() {
    return this.panel.state.drawn.length;
  }

  play(film) {
    this.film = film;
    this.share = 0;
    this.transport.hidden = false;
    document.body.classList.add("playing");
    this.panel.clearDerivatives();
    this.panel.say("▶ In motion", "What moves is no equilibrium: close the time bar, or move a slider, to come back to it.", "");
    this.pause(false);
  }

  pause(paused) {
    this.paused = paused;
    this.toggle.textContent = paused ? "▶" : "❚❚";
    if (!paused) {
      this.last = performance.now();
      requestAnimationFrame((now) => this.tick(now));
    }
  }

  tick(now) {
    if (this.paused || !this.film) return;
    const elapsed = (now - this.last) / 1000;
    this.last = now;
    // A machine that draws slowly leaves no picture of a film out: it films for longer.
    const filmed = this.rolling ? Math.min(elapsed, 1 / FILM_RATE) : 0;
    const shown = this.recorder ? filmed : elapsed;
    const share = this.share + (shown * Number(this.speed.value)) / this.film.duration;
    if (this.share >= 1 && this.recorder?.state === "recording") this.recorder.stop();
    this.seek(this.recorder ? Math.min(share, 1) : share % 1);
    if (this.recorder) this.panel.scenery.printOn(this.sheet);
    requestAnimationFrame((later) => this.tick(later));
  }

  // One run from its beginning, in a file: the format is that of the browser.
  record() {
    if (this.recorder) return;
    this.sheet = this.panel.scenery.printOn(document.createElement("canvas"));
    const pieces = [];
    this.recorder = new MediaRecorder(this.sheet.captureStream(FILM_RATE));
    // What is drawn before the first pictures are in the file would be missing from it.
    this.rolling = false;
    this.recorder.ondataavailable = (event) => {
      pieces.push(event.data);
      this.rolling ||= event.data.size > 0;
    };
    this.recorder.onstop = () => {
      const { mimeType } = this.recorder;
      this.recorder = null;
      offer(new Blob(pieces, { type: mimeType }), mimeType.includes("mp4") ? "mp4" : "webm");
    };
    this.recorder.start(FIRST_PICTURES);
    this.share = 0;
    if (this.paused) this.pause(false);
  }

  // Show the picture at a share of the time.
  seek(share) {
    this.share = share;
    const { frames, count, start, duration, words } = this.film;
    // A mode's last picture is followed by its first; of a motion the last is the end.
    const index = Math.min(Math.floor(share * (words ? count : count - 1) + 1e-9), count - 1);
    this.panel.scenery.draw(frames.subarray(index * this.size, (index + 1) * this.size));
    this.bar.value = share;
    this.clock.textContent = words || `${(start + share * duration).toFixed(3)} s`;
  }

  close() {
    if (!this.film) return;
    if (this.recorder) this.recorder.stop();
    this.film = null;
    this.transport.hidden = true;
    document.body.classList.remove("playing");
    this.panel.scenery.draw(this.panel.state.drawn, this.panel.state.found, this.panel.state.contacts);
    this.panel.showDerivatives();
    this.panel.showStatus();
  }
}

// Pictures from 32-bit floats in base64.
function unpacked(text, size) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const frames = new Float32Array(bytes.buffer);
  return { frames, count: frames.length / size };
}
