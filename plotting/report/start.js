// Joins the parts: the scene follows the player, buttons of the page act on both.
(function (page) {
  "use strict";
  const scene = page.scene;
  const begin = page.data.live ? page.data.end : page.data.start;  // of a run that goes on: its newest instant
  const all = (selector) => document.querySelectorAll(selector);

  for (const button of all("button.when")) {
    button.addEventListener("click", () => {
      page.player.play(false);
      page.player.go(Number(button.dataset.time));
      page.showClaim(button.dataset.claim);
    });
  }
  for (const button of all("[data-zoom]")) button.addEventListener("click", () => page.zoom(button.dataset.zoom));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", page.repaintPlots);

  if (!scene) {
    for (const element of all(".view-tools, #layers, #readout")) element.remove();
    page.player.go(begin);
    return;
  }

  const views = {front: [1, 0, 0.001], side: [0, -1, 0.001], top: [0, -0.001, 1], free: [1, -1.25, 0.62]};  // where the eye is
  for (const button of all("[data-view]")) {
    button.addEventListener("click", () => {
      const name = button.dataset.view;
      if (name === "nearer" || name === "further") scene.dolly(name === "nearer" ? 0.8 : 1.25);
      else scene.look(new THREE.Vector3(...views[name]));
    });
  }

  for (const [name, layer] of Object.entries(scene.layers)) {
    const label = document.createElement("label"), box = document.createElement("input"), mark = document.createElement("i");
    box.type = "checkbox";
    box.checked = layer.group.visible;
    box.dataset.layer = name;
    mark.style.background = layer.colour;
    box.addEventListener("change", () => { layer.group.visible = box.checked; caption(); scene.show(page.player.time); });
    label.append(box, mark, document.createTextNode(layer.text));
    document.getElementById("layers").append(label);
  }

  // Scales of what has no length: force and ellipsoids.
  function caption() {
    const words = [`floor squares ${page.number(scene.cell, 2)} m`];
    for (const scale of scene.scales || [])
      if (scene.layers[scale.name].group.visible) words.push(`${scale.text}: 0.1 m is ${page.number(0.1 * scale.perMetre, 2)} ${scale.unit}`);
    if (scene.forceScale && scene.layers.force.group.visible) words.push(`force: 0.1 m is ${page.number(0.1 / scene.forceScale, 2)} N`);
    if (!scene.webgl) words.push("drawn without WebGL, coarsely");
    document.getElementById("view-caption").textContent = words.join(" · ");
  }

  caption();
  page.player.listen(scene.show);
  page.player.go(begin);
})(window.osculate);
