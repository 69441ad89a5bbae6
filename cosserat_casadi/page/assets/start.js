// Puts a page together once all of it is there.

async function start() {
  const facts = JSON.parse(document.getElementById("facts").textContent);
  const robot = await openRobot(facts);
  const scenery = new Scenery(document.getElementById("canvas"), facts);
  const panel = new Panel(facts, robot, scenery);
  window.robot = panel.api;
  await panel.reset();
  document.body.dataset.ready = "yes";
}
