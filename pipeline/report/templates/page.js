"use strict";
(() => {
  // The only buttons are those that stay on this page: plotly's own bar would offer to upload the data.
  const settings = {
    responsive: true, displaylogo: false, plotlyServerURL: "", modeBarButtons: [["toImage", "zoom2d", "pan2d", "resetScale2d"]],
  };

  // Colours are variables of the style sheet, so that one figure serves the light, the dark and the printed page.
  function coloured(value, style) {
    if (typeof value === "string") {
      return value.startsWith("var(--") ? style.getPropertyValue(value.slice(4, -1)).trim() : value;
    }
    if (Array.isArray(value)) return value.map((entry) => coloured(entry, style));
    if (value === null || typeof value !== "object" || ArrayBuffer.isView(value)) return value;
    return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, coloured(entry, style)]));
  }

  function draw(plot, figure) {
    if (plot.closest("details:not([open])")) return null; // drawn when it is opened
    const { data, layout } = coloured(figure, getComputedStyle(document.documentElement));
    return Plotly.react(plot, data, layout, settings);
  }

  const decode = ({ bdata }) => new Float32Array(Uint8Array.from(atob(bdata), (c) => c.charCodeAt(0)).buffer);
  const minus = (one, other) => one.map((value, index) => value - other[index]);

  const axis = (title, more) => ({
    title: { text: title, standoff: 8 }, automargin: true, gridcolor: "var(--grid)", linecolor: "var(--grid)",
    zerolinecolor: "var(--grid)", ticks: "outside", tickcolor: "var(--grid)", ...more,
  });

  function traceFigure(series) {
    const t = decode(series.t), measured = decode(series.measured);
    const unit = series.unit ? ` (${series.unit})` : "";
    const line = (y, name, color, more) => ({ type: "scatter", mode: "lines", x: t, y, name, line: { color, width: 1.3 }, ...more });
    const below = { yaxis: "y2", showlegend: false };
    const data = [
      line(measured, "measured", "var(--measured)", { line: { color: "var(--measured)", width: 2.5 } }),
      line(decode(series.before), "simulated before", "var(--before)"),
      line(decode(series.after), "simulated after", "var(--after)"),
      line(minus(measured, decode(series.before)), "difference before", "var(--before)", below),
      line(minus(measured, decode(series.after)), "difference after", "var(--after)", below),
    ];
    const layout = {
      font: { color: "var(--ink)", size: 12, family: "system-ui, sans-serif" },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 56, r: 16, t: 52, b: 44 },
      legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom" }, hovermode: "x unified",
      hoverlabel: { bgcolor: "var(--raised)" }, modebar: { bgcolor: "rgba(0,0,0,0)", color: "var(--faint)", activecolor: "var(--ink)" },
      xaxis: axis("time since the run began (s)", { anchor: "y2" }),
      yaxis: axis(series.title + unit, { domain: [0.42, 1] }),
      yaxis2: axis("difference" + unit, { domain: [0, 0.36], zeroline: true }),
    };
    return { data, layout };
  }

  function traceView(view) {
    const series = JSON.parse(view.querySelector("script.series").textContent);
    const [run, channel] = view.querySelectorAll("select");
    const plot = view.querySelector(".plot"), absent = view.querySelector(".absent");
    const redraw = () => {
      const chosen = series.find((entry) => entry.run === run.value && entry.channel === channel.value);
      absent.hidden = Boolean(chosen);
      plot.hidden = !chosen;
      return chosen && draw(plot, traceFigure(chosen));
    };
    run.addEventListener("change", redraw);
    channel.addEventListener("change", redraw);
    return redraw;
  }

  const views = [...document.querySelectorAll("script.figure")].map((script) => {
    const figure = JSON.parse(script.textContent);
    return () => draw(script.parentElement.querySelector(".plot"), figure);
  });
  views.push(...[...document.querySelectorAll(".traces")].map(traceView));
  const drawAll = () => Promise.all(views.map((view) => view()));

  document.querySelectorAll("details").forEach((folded) => folded.addEventListener("toggle", drawAll));
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
  window.addEventListener("beforeprint", () => { document.documentElement.dataset.print = ""; drawAll(); });
  window.addEventListener("afterprint", () => { delete document.documentElement.dataset.print; drawAll(); });
  drawAll().then(() => { document.documentElement.dataset.drawn = ""; });
})();
