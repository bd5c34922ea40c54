"use strict";
(() => {
  function traceFigure(series) {
    const unit = series.unit ? ` (${series.unit})` : "";
    const line = (y, name, colour, width) => ({ kind: "line", x: series.t, y, name, colour, width });
    const signal = [
      line(series.measured, "measured", "var(--measured)", 2.5),
      line(series.before, "simulated before", "var(--before)", 1.3),
      line(series.after, "simulated after", "var(--after)", 1.3),
    ];
    const rest = (y, said, colour) => ({ kind: "line", x: series.t, y, said, colour, width: 1.3 });
    const difference = [rest(series.left_before, "difference before", "var(--before)"), rest(series.left_after, "difference after", "var(--after)")];
    return {
      x: "time since the run began (s)",
      height: 460,
      panels: [
        { title: series.title + unit, marks: signal, share: 0.62 },
        { title: `measured minus simulated${unit}`, marks: difference, share: 0.38, zero: true },
      ],
    };
  }

  function traceView(view) {
    const series = JSON.parse(view.querySelector("script.series").textContent);
    const [run, channel] = view.querySelectorAll("select");
    const plot = view.querySelector(".plot"), absent = view.querySelector(".absent");
    const show = () => {
      const chosen = series.find((entry) => entry.run === Number(run.value) && entry.channel === Number(channel.value));
      absent.hidden = Boolean(chosen);
      plot.hidden = !chosen;
      if (chosen) chart(plot, traceFigure(chosen));
    };
    run.addEventListener("change", show);
    channel.addEventListener("change", show);
    show();
  }

  // A table that is wider than its box fades where it goes on.
  function fade(box) {
    const look = () => box.classList.toggle("more", box.scrollWidth - box.clientWidth - box.scrollLeft > 1);
    box.addEventListener("scroll", look);
    new ResizeObserver(look).observe(box);
  }

  document.querySelectorAll(".plot").forEach((plot, number) => { plot.dataset.number = number; });
  document.querySelectorAll("script.figure").forEach((script) => {
    chart(script.parentElement.querySelector(".plot"), JSON.parse(script.textContent));
  });
  document.querySelectorAll(".traces").forEach(traceView);
  document.querySelectorAll(".scroll").forEach(fade);
  const watch = new ResizeObserver((entries) => entries.forEach(({ target }) => target.redraw?.()));
  document.querySelectorAll(".plot").forEach((plot) => watch.observe(plot));
  document.documentElement.dataset.drawn = "";
})();
