// The time that is shown: play, pause, scrub, speed, keys. Others listen with player.listen(f); f gets the time in s.
(function (page) {
  "use strict";
  const {start, end} = page.data;
  const times = page.data.motion ? page.data.motion.time : Float64Array.of(start, end);
  const listeners = [];
  const element = (id) => document.getElementById(id);
  const speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
  const player = {time: start, playing: false, speed: 1};
  let last = null;  // ms of the frame before

  player.listen = (f) => { listeners.push(f); f(player.time); };

  player.go = function (time) {
    player.time = Math.min(end, Math.max(start, time));
    element("slider").value = player.time;
    element("slider").setAttribute("aria-valuetext", page.number(player.time) + " seconds");
    const digits = end - start < 1 ? 4 : end - start < 1000 ? 3 : 1;
    element("clock").innerHTML = player.time.toFixed(digits) + ' s<span class="whole"> of ' + page.number(end) + " s</span>";
    for (const f of listeners) f(player.time);
  };

  // Moves by whole recorded instants; from between two of them to the nearer end in that direction.
  player.step = function (count) {
    const {at, share} = page.place(times, player.time);
    const from = share > 0 && count < 0 ? at + 1 : at;
    player.go(times[Math.min(times.length - 1, Math.max(0, from + count))]);
  };

  player.play = function (on) {
    if (on && player.time >= end) player.go(start);
    player.playing = on;
    last = null;
    element("play").textContent = on ? "❚❚" : "▶";
    element("play").setAttribute("aria-label", on ? "pause" : "play");
    if (on) requestAnimationFrame(advance);
  };

  function advance(now) {
    if (!player.playing) return;
    if (last !== null) player.go(player.time + player.speed * (now - last) / 1000);
    last = now;
    if (player.time >= end) player.play(false); else requestAnimationFrame(advance);
  }

  player.setSpeed = function (speed) {
    player.speed = speed;
    element("speed").value = String(speed);
  };

  function key(event) {
    const target = event.target, tag = target.tagName;
    if (event.ctrlKey || event.metaKey || event.altKey || tag === "SELECT" || tag === "TEXTAREA" || tag === "PRE") return;
    const fiftieth = (end - start) / 50;
    const at = speeds.indexOf(player.speed);
    const actions = {
      " ": () => player.play(!player.playing),
      ArrowRight: () => event.shiftKey ? player.go(player.time + fiftieth) : player.step(1),
      ArrowLeft: () => event.shiftKey ? player.go(player.time - fiftieth) : player.step(-1),
      Home: () => player.go(start),
      End: () => player.go(end),
      "+": () => player.setSpeed(speeds[Math.min(speeds.length - 1, at + 1)]),
      "-": () => player.setSpeed(speeds[Math.max(0, at - 1)]),
    };
    const action = actions[event.key];
    const presses = event.key === " " && (tag === "BUTTON" || tag === "SUMMARY" || tag === "A" || target.type === "checkbox");
    if (!action || presses) return;
    event.preventDefault();
    action();
  }

  const slider = element("slider"), choice = element("speed");
  slider.min = start;
  slider.max = end > start ? end : start + 1;
  slider.addEventListener("input", () => { player.play(false); player.go(Number(slider.value)); });
  for (const speed of speeds) choice.add(new Option(speed + "×", String(speed)));
  choice.addEventListener("change", () => { player.speed = Number(choice.value); });
  element("play").addEventListener("click", () => player.play(!player.playing));
  document.addEventListener("keydown", key);
  const length = end - start;  // a run takes between 4 s and 20 s to watch, if it can
  player.setSpeed(length / 20 > 1 ? speeds.find((speed) => length / speed <= 20) || 5000
                                  : [...speeds].reverse().find((speed) => speed <= 1 && length / speed >= 4) || 0.01);
  page.player = player;
})(window.osculate);
