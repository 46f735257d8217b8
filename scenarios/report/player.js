"use strict";
(() => {
  const mission = JSON.parse(document.getElementById("mission").textContent);
  const range = document.getElementById("time");
  const button = document.getElementById("play");
  const output = document.getElementById("clock");
  const trails = [...document.querySelectorAll(".trail")];
  const bodies = [...document.querySelectorAll(".robot")];
  const targets = [...document.querySelectorAll(".target")];
  const blockades = [...document.querySelectorAll(".blockade[x1]")];
  const plans = [...document.querySelectorAll(".plan")];
  const chart = document.querySelector(".gantt");
  const cursor = chart.querySelector(".cursor");
  const [left, right] = [Number(chart.dataset.left), Number(chart.dataset.right)];
  const clock = (t) => `${Math.floor(t / 60)}:${String(Math.floor(t % 60)).padStart(2, "0")}`;
  const happened = (value, t) => value !== undefined && Number(value) <= t;

  /** Index of the last sample not later than t. */
  function before(trail, t) {
    let low = 0, high = trail.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (trail[middle][0] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  function show(t) {
    output.textContent = `${clock(t)} / ${clock(mission.end)}`;
    mission.trails.forEach((trail, k) => {
      if (!trail.length) return;
      const i = before(trail, t), [t0, x0, y0] = trail[i];
      const [t1, x1, y1] = trail[Math.min(i + 1, trail.length - 1)];
      const share = t1 > t0 ? Math.min(1, Math.max(0, (t - t0) / (t1 - t0))) : 0;
      const x = x0 + (x1 - x0) * share, y = y0 + (y1 - y0) * share;
      const driven = trail.slice(0, i + 1).map((p) => `${p[1]},${p[2]}`);
      trails[k].setAttribute("points", [...driven, `${x},${y}`].join(" "));
      bodies[k].setAttribute("transform", `translate(${x} ${y})`);
    });
    for (const target of targets) target.classList.toggle("visited", happened(target.dataset.visited, t));
    for (const line of blockades) {
      const seen = happened(line.dataset.seen, t), cleared = happened(line.dataset.cleared, t);
      line.classList.toggle("unseen", !seen);
      line.classList.toggle("seen", seen && !cleared);
      line.classList.toggle("cleared", cleared);
    }
    let current = 0;
    plans.forEach((plan, k) => { if (Number(plan.dataset.from) <= t) current = k; });
    plans.forEach((plan, k) => plan.classList.toggle("shown", k === current));
    const place = left + (right - left) * (mission.end ? t / mission.end : 1);
    cursor.setAttribute("x1", place);
    cursor.setAttribute("x2", place);
  }

  let playing = false, last = 0;
  const speed = Math.max(1, mission.end / 30); // a mission plays in half a minute
  function frame(now) {
    if (!playing) return;
    const t = Math.min(mission.end, Number(range.value) + ((now - last) / 1000) * speed);
    last = now;
    range.value = t;
    show(t);
    if (t >= mission.end) stop(); else requestAnimationFrame(frame);
  }
  function stop() { playing = false; button.textContent = "▶"; button.ariaLabel = "play"; }
  button.addEventListener("click", () => {
    if (playing) return stop();
    if (Number(range.value) >= mission.end) range.value = 0;
    playing = true;
    button.textContent = "❚❚";
    button.ariaLabel = "pause";
    last = performance.now();
    requestAnimationFrame(frame);
  });
  range.step = "any";
  range.addEventListener("input", () => { stop(); show(Number(range.value)); });
  document.querySelector(".player").hidden = false;
  output.textContent = `${clock(mission.end)} / ${clock(mission.end)}`;
  const match = location.hash.match(/^#t=([\d.]+)$/); // a link to a moment
  if (match) { range.value = match[1]; show(Number(range.value)); }
})();
