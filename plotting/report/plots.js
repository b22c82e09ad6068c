// The plots: dygraphs with one cursor and one stretch of time for all. Plots of one group share a place and a choice.
(function (page) {
  "use strict";
  const {start, end, touching} = page.data;
  const charts = [];
  const dashes = [null, [7, 3], [7, 2, 2, 2], [2, 3]];
  const shades = 8;
  let stretch = [start, end > start ? end : start + 1];

  const made = (tag, className, text) => {
    const element = document.createElement(tag);
    if (className) element.className = className;
    if (text !== undefined) element.textContent = text;
    return element;
  };

  // A piece of the line, as in the plot, so that colour is not the only sign.
  function swatch(index) {
    const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    line.setAttribute("width", "22");
    line.setAttribute("height", "8");
    line.setAttribute("aria-hidden", "true");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("d", "M0 4H22");
    path.setAttribute("style", `stroke:var(--series-${index % shades});stroke-width:2;stroke-dasharray:${(dash(index) || []).join(" ")}`);
    line.appendChild(path);
    return line;
  }
  const dash = (index) => dashes[(Math.floor(index / shades) + (index % shades)) % dashes.length];

  function rows(plot) {
    return Array.from(plot.x, (x, i) => [x, ...plot.lines.map((line) => (isNaN(line[i]) ? NaN : line[i]))]);
  }

  // Marks of a logarithmic scale: powers of ten where there are three or more, else 1, 2, 5.
  function powers(low, high, pixels) {
    const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high)), marks = [];
    const many = Math.log10(high / low) >= 2.5, stride = Math.max(1, Math.ceil((last - first) / (pixels / 20)));
    for (let power = Math.ceil(first / stride) * stride; power <= last; power += stride)
      for (const digit of many ? [1] : [1, 2, 5]) {
        const value = Number(digit + "e" + power);
        if (value >= low && value <= high) marks.push({v: value, label: value >= 0.01 && value < 1000 ? String(value) : digit + "e" + power});
      }
    return marks;
  }

  function options(plot, chart) {
    const soft = page.colour("soft"), faint = page.colour("line");
    const series = {};
    plot.names.forEach((name, i) => { series[key(i)] = {strokePattern: dash(i)}; });
    return {
      labels: ["time", ...plot.names.map((_, i) => key(i))], colors: plot.names.map((_, i) => page.colour("series-" + i % shades)),
      series: series, legend: "never", strokeWidth: 1.5, highlightCircleSize: 0, showLabelsOnHighlight: false, logscale: plot.log,
      dateWindow: stretch, axisLineColor: soft, gridLineColor: faint, gridLineWidth: 0.5, xAxisHeight: 18, digitsAfterDecimal: 4,
      axes: {y: {axisLabelWidth: 52, pixelsPerLabel: 28, axisLabelFormatter: (value) => String(Number(value.toPrecision(4))),
                 ...(plot.log ? {ticker: powers} : {})},
             x: {axisLabelFormatter: (value) => String(Number(value.toPrecision(6))) + " s", pixelsPerLabel: 70}},
      interactionModel: interaction, underlayCallback: shade, rightGap: 12,
      drawCallback: (graph) => moveCursor(chart, graph),
      zoomCallback: (from, to) => setStretch([from, to]),
    };
  }
  const key = (i) => "line " + i;

  // Contact of the tip, behind the lines.
  function shade(canvas, area, graph) {
    canvas.fillStyle = page.colour("mark");
    for (const [from, to] of touching) {
      const left = Math.max(area.x, graph.toDomXCoord(from)), right = Math.min(area.x + area.w, graph.toDomXCoord(to));
      if (right > left) canvas.fillRect(left, area.y, right - left, area.h);
    }
  }

  function timeAt(event, graph) {
    return graph.toDataXCoord(event.clientX - graph.graphDiv.getBoundingClientRect().left);
  }
  const interaction = {
    pointerdown(event, graph, state) {
      if (event.button !== 0) return;
      state.scrubs = !event.shiftKey;
      if (state.scrubs) {
        page.player.play(false);
        page.player.go(timeAt(event, graph));
        event.target.setPointerCapture(event.pointerId);
      }
    },
    pointermove(event, graph, state) { if (state.scrubs) page.player.go(timeAt(event, graph)); },
    pointerup(event, graph, state) { state.scrubs = false; },
    pointercancel(event, graph, state) { state.scrubs = false; },
    mousedown(event, graph, state) {
      state.initializeMouseDown(event, graph, state);
      if (event.shiftKey) Dygraph.startZoom(event, graph, state);
    },
    mousemove(event, graph, state) { if (state.isZooming) Dygraph.moveZoom(event, graph, state); },
    mouseup(event, graph, state) { if (state.isZooming) Dygraph.endZoom(event, graph, state); },
    dblclick() { setStretch([start, end]); },
  };

  function setStretch([from, to]) {
    const least = (end - start) / 5000 || 1e-6, length = Math.min(end - start, Math.max(least, to - from));
    from = Math.min(Math.max(start, from), end - length);
    stretch = [from, from + length];
    for (const chart of charts) if (chart.graph) chart.graph.updateOptions({dateWindow: stretch});
  }

  // Narrows or widens the stretch about the cursor.
  page.zoom = function (how) {
    const [from, to] = stretch, time = Math.min(to, Math.max(from, page.player.time));
    if (how === "all") return setStretch([start, end]);
    const factor = how === "in" ? 0.5 : 2;
    setStretch([time - factor * (time - from), time + factor * (to - time)]);
  };

  function moveCursor(chart, graph) {
    const area = graph.getArea(), left = graph.toDomXCoord(page.player.time);
    chart.cursor.style.left = left + "px";
    chart.cursor.hidden = left < area.x - 1 || left > area.x + area.w + 1;
  }

  function showValues(chart) {
    const row = page.nearest(chart.plot.x, page.player.time);
    chart.values.forEach((place, i) => { place.textContent = page.number(chart.plot.lines[i][row]); });
  }

  // Draws `plot` in the chart's place, instead of what was there.
  function draw(chart, plot) {
    chart.plot = plot;
    chart.unit.textContent = "[" + plot.unit + "]";
    if (chart.title) chart.title.textContent = plot.title;
    chart.legend.replaceChildren();
    chart.values = plot.names.map((name, i) => {
      const item = made("li"), value = made("b");
      item.append(swatch(i), made("span", "", name), value);
      chart.legend.append(item);
      return value;
    });
    chart.drawing.setAttribute("aria-label", `${plot.title} in ${plot.unit} over time in s: ${plot.names.join(", ")}`);
    if (chart.graph) chart.graph.destroy();
    chart.drawing.replaceChildren();
    chart.graph = new Dygraph(chart.drawing, rows(plot), options(plot, chart));
    chart.drawing.append(chart.cursor);
    moveCursor(chart, chart.graph);
    showValues(chart);
  }

  function place(plots) {
    const chart = {plots: plots, cursor: made("div", "cursor"), values: []};
    const section = made("section", "plot"), head = made("h3");
    chart.unit = made("span", "unit");
    chart.legend = made("ul", "legend");
    chart.drawing = made("div", "drawing");
    chart.drawing.setAttribute("role", "img");
    if (plots[0].group) {
      chart.choice = made("select");
      chart.choice.setAttribute("aria-label", "claim that is shown");
      plots.forEach((plot, i) => chart.choice.add(new Option(plot.choice, i)));
      chart.choice.addEventListener("change", () => draw(chart, plots[chart.choice.value]));
      head.append(made("span", "", plots[0].group), chart.choice, chart.unit);
    } else {
      chart.title = made("span");
      head.append(chart.title, chart.unit);
    }
    section.append(head, chart.legend, chart.drawing);
    document.getElementById("plots").append(section);
    charts.push(chart);
    draw(chart, plots[0]);
  }

  // Shows a claim at the instant of its worst residual.
  page.showClaim = function (claim) {
    for (const chart of charts) {
      const index = chart.plots.findIndex((plot) => plot.title === "claim " + claim);
      if (index < 0) continue;
      chart.choice.value = index;
      draw(chart, chart.plots[index]);
      chart.drawing.scrollIntoView({block: "center"});
    }
  };

  const done = new Set();
  for (const plot of page.data.plots) {
    if (plot.group && done.has(plot.group)) continue;
    done.add(plot.group);
    place(plot.group ? page.data.plots.filter((other) => other.group === plot.group) : [plot]);
  }
  if (!charts.length) document.getElementById("plots").append(made("p", "note", "No instant was recorded: there is nothing to plot."));

  let waiting = false;
  page.player.listen(() => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      for (const chart of charts) {
        moveCursor(chart, chart.graph);
        showValues(chart);
      }
    });
  });
  page.plots = charts;
  page.repaintPlots = () => { for (const chart of charts) draw(chart, chart.plot); };
})(window.osculate);
