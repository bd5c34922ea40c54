"use strict";
// Draws lines, bands and points as SVG. Colours are variables of the style sheet: one drawing serves light, dark and print.
const chart = (() => {
  const NAMESPACE = "http://www.w3.org/2000/svg", TICK = 12, GAP = 34, TOP = 22;
  const ruler = document.createElement("canvas").getContext("2d");
  ruler.font = `${TICK}px system-ui, sans-serif`;
  const wide = (text) => ruler.measureText(text).width;

  function add(parent, name, attributes, text) {
    const element = document.createElementNS(NAMESPACE, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    parent.append(element);
    return element;
  }

  // Numbers come as a list, or as 16-bit steps above the lowest: finer than any screen.
  function decode(coded) {
    if (Array.isArray(coded)) return Float64Array.from(coded, (value) => value ?? NaN);
    const bytes = Uint8Array.from(atob(coded.u2), (letter) => letter.charCodeAt(0));
    return Float64Array.from(new Uint16Array(bytes.buffer), (k) => (k === 65535 ? NaN : coded.low + coded.step * k));
  }

  const minus = (text) => text.replace(/-/g, "\u2212");
  const raised = (power) => String(power).replace(/[-\d]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);

  function written(value, step) {
    const size = Math.abs(value);
    if (size !== 0 && (size >= 1e5 || step < 1e-4)) {
      const power = Math.floor(Math.log10(size) + 1e-9);
      const digits = Math.min(Math.max(power - Math.floor(Math.log10(step) + 1e-9), 0), 6);
      return minus(`${(value / 10 ** power).toFixed(digits)}×10`) + raised(power);
    }
    return minus((size < step * 1e-6 ? 0 : value).toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))));
  }

  function linearTicks(low, high, most) {
    const rough = (high - low) / Math.max(most, 1), power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) ticks.push([k * step, written(k * step, step)]);
    return ticks;
  }

  function logTicks(low, high, most) {
    const first = Math.floor(low), last = Math.ceil(high), ticks = [];
    const factors = last - first <= 2 ? [1, 2, 5] : [1], stride = Math.max(1, Math.ceil((last - first) / Math.max(most, 1)));
    for (let power = first; power <= last; power += stride) {
      for (const factor of factors) {
        const place = power + Math.log10(factor), value = factor * 10 ** power;
        const text = power >= -3 && power < 4 ? written(value, 10 ** Math.min(power, 0)) : `${factor === 1 ? "" : `${factor}×`}10${raised(power)}`;
        if (place >= low - 1e-9 && place <= high + 1e-9) ticks.push([place, text]);
      }
    }
    return ticks;
  }

  // As many ticks along x as stand side by side without touching.
  function ticksThatFit(low, high, length) {
    for (let most = Math.floor(length / 40); most > 1; most -= 1) {
      const ticks = linearTicks(low, high, most);
      const widest = Math.max(0, ...ticks.map(([, text]) => wide(text)));
      if (ticks.length < 2 || (ticks[1][0] - ticks[0][0]) / (high - low) * length > widest + 12) return ticks;
    }
    return linearTicks(low, high, 1);
  }

  function extent(values) {
    let low = Infinity, high = -Infinity;
    for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
    return low > high ? [0, 1] : low === high ? [low - 0.5, high + 0.5] : [low, high];
  }

  const series = (mark) => [mark.y, mark.low, mark.high].filter(Boolean);

  function rangeOf(panel, view) {
    const seen = [];
    for (const mark of panel.marks) {
      for (const values of series(mark)) {
        values.forEach((value, index) => {
          const inside = mark.x[index] >= view[0] && mark.x[index] <= view[1];
          if (inside && Number.isFinite(value) && (!panel.log || value > 0)) seen.push(panel.log ? Math.log10(value) : value);
        });
      }
    }
    if (panel.zero && !panel.log) seen.push(0);
    const [low, high] = extent(seen), room = (high - low) * 0.05;
    return [panel.zero && low === 0 ? 0 : low - room, high + room];
  }

  function path(mark, values, x, y) {
    let text = "", pen = "M";
    values.forEach((value, index) => {
      const height = y(value);
      if (!Number.isFinite(height)) { pen = "M"; return; }
      text += `${pen}${x(mark.x[index]).toFixed(1)} ${height.toFixed(1)}`;
      pen = "L";
    });
    return text;
  }

  function drawMark(group, mark, x, y) {
    const stroke = { stroke: mark.colour, "stroke-width": mark.width ?? 2, fill: "none", "stroke-linejoin": "round" };
    if (mark.kind === "band") {
      const back = [...mark.x.keys()].reverse().map((index) => `L${x(mark.x[index]).toFixed(1)} ${y(mark.low[index]).toFixed(1)}`);
      add(group, "path", { d: `${path(mark, mark.high, x, y)}${back.join("")}Z`, fill: mark.colour });
    } else if (mark.kind === "line") {
      add(group, "path", { d: path(mark, mark.y, x, y), ...stroke, ...(mark.dash ? { "stroke-dasharray": "6 4" } : {}) });
    }
    if (!mark.dot) return;
    let bars = "", dots = "";
    mark.y.forEach((value, index) => {
      const [left, height, r] = [x(mark.x[index]), y(value), mark.dot];
      if (!Number.isFinite(left + height)) return;
      dots += `M${(left - r).toFixed(1)} ${height.toFixed(1)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
      if (mark.low) bars += `M${left.toFixed(1)} ${y(mark.low[index]).toFixed(1)}L${left.toFixed(1)} ${y(mark.high[index]).toFixed(1)}`;
    });
    if (bars) add(group, "path", { d: bars, stroke: mark.colour, "stroke-width": 1.2, fill: "none" });
    add(group, "path", { d: dots, fill: mark.hollow ? "var(--paper)" : mark.colour, stroke: mark.hollow ? mark.colour : "none", "stroke-width": 1.5, opacity: mark.opacity ?? 1 });
  }

  function shortened(text, room) {
    let shown = text;
    while (shown.length > 1 && wide(shown) > room) shown = `${shown.slice(0, -2)}…`;
    return shown;
  }

  function legendOf(panels) {
    const legend = document.createElement("div"), seen = new Set();
    legend.className = "legend";
    for (const mark of panels.flatMap((panel) => panel.marks)) {
      if (!mark.name || seen.has(mark.name)) continue;
      seen.add(mark.name);
      const key = document.createElement("span"), swatch = document.createElement("i");
      swatch.className = mark.hollow ? "hollow" : mark.kind;
      swatch.style.setProperty("--colour", mark.colour);
      key.append(swatch, mark.name);
      legend.append(key);
    }
    return legend;
  }

  function numbers(spec) {
    const read = (mark) => ({ ...mark, ...Object.fromEntries(["x", "y", "low", "high"].filter((key) => mark[key]).map((key) => [key, decode(mark[key])])) });
    return spec.panels.map((panel) => ({ ...panel, marks: panel.marks.map(read) }));
  }

  return function (plot, spec) {
    const panels = numbers(spec), marks = panels.flatMap((panel) => panel.marks);
    const [first, last] = extent(marks.flatMap((mark) => [...mark.x])), room = marks.some((mark) => mark.dot) ? 0.015 * (last - first) : 0;
    const whole = [first - room, last + room]; // the outermost points are seen whole
    let view = whole;
    const svg = document.createElementNS(NAMESPACE, "svg"), tip = document.createElement("div");
    tip.className = "tip";
    tip.hidden = true;
    plot.replaceChildren(legendOf(panels), svg, tip);
    let frame = null;

    function draw() {
      const width = plot.clientWidth, height = spec.height;
      if (!width) return;
      svg.replaceChildren();
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      svg.setAttribute("height", height);
      const free = height - panels.length * TOP - GAP - 8, ranges = panels.map((panel) => rangeOf(panel, view));
      const heights = panels.map((panel) => free * (panel.share ?? 1));
      const ticks = panels.map((panel, i) => (panel.log ? logTicks : linearTicks)(...ranges[i], Math.floor(heights[i] / 28)));
      const left = 12 + Math.max(...ticks.flat().map(([, text]) => wide(text)), 10), right = 22;
      const x = (value) => left + ((value - view[0]) / (view[1] - view[0])) * (width - left - right);
      const bottom = height - GAP, edges = { x1: left, x2: width - right };
      const along = ticksThatFit(...view, width - left - right);
      const clip = add(svg, "clipPath", { id: `clip${plot.dataset.number}` });
      add(clip, "rect", { x: left, y: 0, width: Math.max(width - left - right, 0), height });
      let top = 0;
      panels.forEach((panel, i) => {
        top += TOP;
        const [low, high] = ranges[i], base = top + heights[i];
        const y = (value) => base - (((panel.log ? Math.log10(value) : value) - low) / (high - low)) * heights[i];
        add(svg, "text", { x: 4, y: top - 9, class: "title" }, shortened(panel.title, width - 8));
        for (const [place, text] of ticks[i]) {
          const at = base - ((place - low) / (high - low)) * heights[i];
          add(svg, "line", { ...edges, y1: at, y2: at, class: place === 0 && !panel.log ? "axis" : "grid" });
          add(svg, "text", { x: left - 6, y: at + 4, "text-anchor": "end" }, text);
        }
        for (const [place] of along) add(svg, "line", { x1: x(place), x2: x(place), y1: top, y2: base, class: "grid" });
        const group = add(svg, "g", { "clip-path": `url(#clip${plot.dataset.number})` });
        for (const mark of panel.marks) drawMark(group, mark, x, y);
        top = base;
      });
      for (const [place, text] of along) add(svg, "text", { x: x(place), y: bottom + 8, "text-anchor": "middle" }, text);
      add(svg, "text", { x: width - right, y: height - 6, "text-anchor": "end", class: "title" }, shortened(spec.x, width - 30));
      const cross = add(svg, "path", { class: "cross", d: "" }), chosen = add(svg, "rect", { class: "chosen", y: TOP, height: bottom - TOP - 8, width: 0 });
      frame = { left, right, width, x, cross, chosen, bottom, value: (pixel) => view[0] + ((pixel - left) / (width - left - right)) * (view[1] - view[0]) };
    }

    function nearest(mark, value) {
      let best = -1;
      for (let i = 0; i < mark.x.length; i += 1) if (Number.isFinite(mark.y[i]) && (best < 0 || Math.abs(mark.x[i] - value) < Math.abs(mark.x[best] - value))) best = i;
      return best;
    }

    function point(pixel) {
      const value = frame.value(pixel), lines = [];
      let at = null;
      for (const mark of panels.flatMap((panel) => panel.marks)) {
        if (mark.silent || !mark.y) continue;
        const index = nearest(mark, value);
        if (index < 0) continue;
        at ??= mark.x[index];
        lines.push(`${mark.name ?? mark.said}: ${minus(String(Number(mark.y[index].toPrecision(4))))}`);
      }
      if (at === null) return;
      tip.hidden = false;
      tip.textContent = [`${spec.x}: ${minus(String(Number(at.toPrecision(4))))}`, ...lines].join("\n");
      tip.style.left = `${Math.min(frame.x(at) + 12, Math.max(frame.width - tip.offsetWidth - 4, 0))}px`;
      frame.cross.setAttribute("d", `M${frame.x(at)} ${TOP}V${frame.bottom - 8}`);
    }

    let pressed = null;
    const pixelOf = (event) => Math.min(Math.max(event.clientX - svg.getBoundingClientRect().left, frame.left), frame.width - frame.right);
    svg.addEventListener("pointermove", (event) => {
      if (!frame) return;
      const pixel = pixelOf(event);
      if (pressed === null) { point(pixel); return; }
      frame.chosen.setAttribute("x", Math.min(pixel, pressed));
      frame.chosen.setAttribute("width", Math.abs(pixel - pressed));
    });
    svg.addEventListener("pointerleave", () => { tip.hidden = true; pressed = null; if (frame) { frame.cross.setAttribute("d", ""); frame.chosen.setAttribute("width", 0); } });
    svg.addEventListener("pointerdown", (event) => { if (frame && event.pointerType === "mouse") { pressed = pixelOf(event); event.preventDefault(); } });
    svg.addEventListener("pointerup", (event) => {
      if (pressed === null) return;
      const [from, to] = [pressed, pixelOf(event)].sort((one, other) => one - other);
      pressed = null;
      if (to - from > 8) { view = [frame.value(from), frame.value(to)]; draw(); }
      else frame.chosen.setAttribute("width", 0);
    });
    svg.addEventListener("dblclick", () => { view = whole; draw(); });
    plot.redraw = draw;
    draw();
  };
})();
