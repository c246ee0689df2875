// Draws the plots of the page for the positions of its controls, marks the load, moves the shape.
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const position = Object.fromEntries(data.controls.map((control) => [control.name, 0]));
  const settings = {responsive: true, displaylogo: false,
    modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"]};
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const FRAME_MS = 50, FRAMES_PER_CYCLE = 40;
  let phase = 0, timer = null;

  const element = (name) => document.getElementById(name);
  const place = (name) => "plot-" + name;
  const controlled = (name) => data.controls.find((control) => control.name === name);

  function filled(trace, shared) {
    const copy = {...trace};
    for (const key of ["x", "y"]) {
      if (typeof copy[key] === "string") copy[key] = shared[copy[key].slice(1)];
    }
    return copy;
  }

  function loadLine() {
    const load = controlled("load");
    if (!load || !load.numbers.length) return [];
    const at = load.numbers[position.load];
    return [{type: "line", x0: at, x1: at, yref: "paper", y0: 0, y1: 1, layer: "below",
      line: {color: "#999", width: 1, dash: "dot"}}];
  }

  function draw(plot) {
    const key = plot.controls.map((name) => position[name]).join(",");
    const traces = (plot.frames[key] || []).map((trace) => filled(trace, plot.shared));
    const layout = {...plot.layout, shapes: [...(plot.layout.shapes || []),
      ...(plot.cursor && traces.length ? loadLine() : [])], uirevision: "kept"};
    if (plot.ranges[key]) layout.yaxis = {...layout.yaxis, range: plot.ranges[key]};
    if (!traces.length) {
      layout.annotations = [{text: plot.empty, showarrow: false, xref: "paper", yref: "paper",
        x: 0.5, y: 0.5, font: {color: "#666"}, width: 260}];
    }
    Plotly.react(place(plot.name), traces, layout, settings);
  }

  function show(changed) {
    const output = element("load-shown");
    if (output) output.textContent = controlled("load").values[position.load];
    tellHere();
    for (const plot of data.plots) {
      const follows = plot.controls.includes(changed) || (plot.cursor && changed === "load");
      if (changed === null || follows) draw(plot);
    }
  }

  function tellHere() {
    const here = element("here");
    if (!here) return;
    const load = controlled("load").numbers[position.load];
    const answer = data.here.find(([gap, place, at]) =>
      gap === position.gap && place === position.place && at === load);
    here.textContent = answer ? answer[3] : "";
  }

  function move() {
    phase = (phase + 2 * Math.PI / FRAMES_PER_CYCLE) % (2 * Math.PI);
    const traces = element(place("shape")).data || [];
    traces.forEach((trace, index) => {
      if (!trace.meta || !trace.meta.re) return;
      const y = trace.meta.re.map((re, at) =>
        re * Math.cos(phase) - trace.meta.im[at] * Math.sin(phase));
      Plotly.restyle(place("shape"), {y: [y]}, [index]);
    });
  }

  function play() {
    if (timer === null) timer = setInterval(move, FRAME_MS);
    else { clearInterval(timer); timer = null; }
    element("play").textContent = timer === null ? "Play" : "Pause";
  }

  for (const control of data.controls) {
    const input = element("control-" + control.name);
    if (!input) continue;
    position[control.name] = Number(input.value);
    input.addEventListener("input", () => {
      position[control.name] = Number(input.value);
      show(control.name);
    });
  }
  const button = element("play");
  if (button) button.addEventListener("click", play);
  if (button && still) button.hidden = true;
  addEventListener("beforeprint",
    () => data.plots.forEach((plot) => Plotly.Plots.resize(place(plot.name))));
  show(null);
})();
