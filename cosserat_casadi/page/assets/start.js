// Puts a page together once all of it is there.

async function start() {
  const facts = JSON.parse(document.getElementById("facts").textContent);
  const robot = await openRobot(facts);
  const scenery = new Scenery(document.getElementById("canvas"), facts);
  const panel = new Panel(facts, robot, scenery);
  window.robot = panel.api;
  window.scenery = scenery;
  await panel.reset();
  if (facts.hand.length) new Hand(panel);
  // Modes and motions need a program behind the page.
  if (facts.modes) window.theatre = new Theatre(panel, facts);
  document.body.dataset.ready = "yes";
}
