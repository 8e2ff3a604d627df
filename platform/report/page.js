// Draws the figures of a report, reads values out by mouse and by key, sorts tables.
// What comes from a result is text here, never markup: textContent, or escaped where the plots' library wants markup.
"use strict";
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const root = document.documentElement;
  const escaped = (text) => text.replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
  const short = (value) => String(Number(value.toPrecision(7)));
  const tick = (value) => value !== 0 && Math.abs(value) < 1e-3 ? Number(value.toPrecision(3)).toExponential() : String(Number(value.toPrecision(5)));
  // Whole decades where there are some: the library's own ticks of a logarithmic axis are any numbers.
  function decades(least, greatest, pixels, ...rest) {
    const [from, to] = [Math.ceil(Math.log10(least)), Math.floor(Math.log10(greatest))];
    if (!(to - from >= 2)) return Dygraph.numericTicks(least, greatest, pixels, ...rest);
    const step = Math.ceil((to - from) / Math.max(1, pixels / 30)), ticks = [];
    for (let k = from; k <= to; k += step) ticks.push({ v: 10 ** k, label: escaped(tick(10 ** k)) });
    return ticks;
  }
  const colour = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const line = (s, i) => colour(`--line-${s.colour ?? (i % 6) + 1}`);
  const dashes = [null, [7, 4], [2, 4]];  // tell lines of one colour apart
  const colours = (figure) => figure.series.map(line)
    .concat(figure.marks.map(() => colour("--mark")));

  // The lines that are drawn: those of the data, then the marks from one end to the other.
  function lines(figure) {
    let least = Infinity, greatest = -Infinity;
    for (const s of figure.series)
      for (const x of s.x) { least = Math.min(least, x); greatest = Math.max(greatest, x); }
    const level = (mark) => ({ name: mark.label, x: least < greatest ? [least, greatest] : [least], y: [mark.at, mark.at] });
    return figure.series.concat(figure.marks.map(level));
  }

  // One row for each x. A point that a line does not have is null, which is joined over; a gap is not.
  function rows(figure, log) {
    const all = lines(figure), many = all.length;
    const value = (s, k, lane) => {
      if (s.y[k] === null) return NaN;
      if (figure.kind === "lanes") return lane + 0.8 * s.y[k];
      return log ? (s.y[k] === 0 ? null : Math.abs(s.y[k])) : s.y[k];
    };
    const table = [], at = new Map();
    all.forEach((s, i) => s.x.forEach((x, k) => {
      let row = figure.kind === "points" ? undefined : at.get(x);
      if (row === undefined) {
        row = [x, ...Array(many).fill(null)];
        at.set(x, row);
        table.push(row);
      }
      row[i + 1] = value(s, k, i);
    }));
    if (table.length === 0) table.push([figure.wide?.[0] ? 1 : 0, ...Array(many).fill(null)]);  // the library draws no empty table
    return table.sort((a, b) => a[0] - b[0]);
  }

  const name_of_x = (figure, x) => figure.kind === "bars" ? figure.labels[Math.round(x)] ?? short(x) : `${figure.x} ${short(x)}`;

  // What each line has nearest to x.
  function values_at(figure, x) {
    const parts = lines(figure).filter((s) => s.x.length > 0).map((s) => {
      let best = 0;
      s.x.forEach((at, k) => { if (Math.abs(at - x) < Math.abs(s.x[best] - x)) best = k; });
      return `${s.name}: ${s.y[best] === null ? "none" : short(s.y[best])}`;
    });
    return `${name_of_x(figure, x)}; ${parts.join("; ")}`;
  }

  function bars(event, figure) {
    if (event.seriesIndex !== 0) return;
    const context = event.drawingContext, area = event.plotArea, plot = event.dygraph;
    const log = plot.getOption("logscale");
    const bottom = area.y + area.h;
    const zero = log ? bottom : Math.min(bottom, Math.max(area.y, plot.toDomYCoord(0)));
    const room = plot.toDomXCoord(1) - plot.toDomXCoord(0), many = figure.series.length, width = 0.8 * room / many;
    figure.series.forEach((s, i) => {
      context.fillStyle = context.strokeStyle = line(s, i);
      s.x.forEach((x, k) => {
        if (s.y[k] === null || (log && s.y[k] === 0)) return;
        const left = plot.toDomXCoord(x) - 0.4 * room + i * width;
        const top = plot.toDomYCoord(log ? Math.abs(s.y[k]) : s.y[k]);
        context.globalAlpha = s.low || s.variant ? 0.5 : 1;
        context.fillRect(left, Math.min(top, zero), Math.max(width - 1, 1), Math.abs(zero - top));
        context.globalAlpha = 1;
        if (s.low) context.fillRect(left + width / 2 - 1, plot.toDomYCoord(s.high[k]), 2,
          Math.max(1, plot.toDomYCoord(s.low[k]) - plot.toDomYCoord(s.high[k])));
      });
    });
    context.fillStyle = colour("--mark");
    for (const mark of figure.marks) context.fillRect(area.x, plot.toDomYCoord(mark.at) - 1, area.w, 2);
  }

  function options(figure, log) {
    const all = lines(figure), many = figure.series.length;
    const o = {
      labels: [figure.x, ...all.map((s, i) => `${i}`)],
      legend: "never", connectSeparatedPoints: true, logscale: log, colors: colours(figure),
      gridLineColor: colour("--grid"), axisLineColor: colour("--grid"), xlabel: escaped(figure.x),
      ylabel: escaped((log && figure.kind !== "bars" && !figure.columns ? "|y| of: " : "") + figure.y), axisLabelFontSize: 12, xLabelHeight: 18, yLabelWidth: 18,
      axes: { x: { axisLabelFormatter: tick }, y: { axisLabelFormatter: tick, axisLabelWidth: 56 } },
      strokeWidth: 1.2, highlightCircleSize: 4, rightGap: 12, series: {},
    };
    o.axes.y.ticker = log ? decades : Dygraph.numericTicks;
    if (figure.wide) Object.assign(o.axes.x, { logscale: figure.wide[0], ticker: figure.wide[0] ? decades : Dygraph.numericTicks });
    figure.series.forEach((s, i) => { if (s.variant) o.series[`${i}`] = { strokePattern: dashes[s.variant % 3] }; });
    all.forEach((_, i) => { if (i >= many) o.series[`${i}`] = { strokePattern: [6, 4], strokeWidth: 1.5 }; });
    if (figure.kind === "points") Object.assign(o, { drawPoints: true, strokeWidth: 0, pointSize: 1.3, highlightSeriesOpts: {} });
    if (figure.kind === "lanes") {
      Object.assign(o, { stepPlot: true, fillGraph: false, valueRange: [-0.2, many] });
      o.axes.y.ticker = () => figure.series.map((s, i) => ({ v: i + 0.4, label: escaped(s.name) }));
      o.axes.y.axisLabelWidth = 92;
    }
    if (figure.kind === "steps") o.stepPlot = true;
    if (figure.kind === "bars") {
      Object.assign(o, { plotter: (event) => bars(event, figure), dateWindow: [-0.6, figure.labels.length - 0.4], includeZero: !log });
      if (figure.series.some((s) => s.high) && !log)
        o.valueRange = [0, 1.05 * Math.max(...figure.series.flatMap((s) => s.high ?? s.y), ...figure.marks.map((m) => m.at))];
      const room = Math.max(40, Math.min(150, 8 + 7 * Math.max(...figure.labels.map((label) => label.length))));
      o.axes.x.axisLabelWidth = room;
      o.axes.x.ticker = (a, b, pixels) => {
        const step = Math.ceil(figure.labels.length * room / pixels);
        return figure.labels.flatMap((label, v) => v % step === 0 ? [{ v, label: escaped(label) }] : []);
      };
    }
    return o;
  }

  function csv(figure) {
    const quoted = (text) => /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
    const head = ["series", figure.kind === "bars" ? "name" : figure.x, figure.y].map(quoted).join(",");
    const row = (s, k) => [quoted(s.name), figure.kind === "bars" ? quoted(figure.labels[s.x[k]] ?? "") : s.x[k], s.y[k] ?? ""].join(",");
    return [head, ...lines(figure).flatMap((s) => s.x.map((_, k) => row(s, k)))].join("\n") + "\n";
  }

  function element(kind, text, attributes = {}) {
    const made = document.createElement(kind);
    made.textContent = text;
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  }

  const drawn = [];  // what is done again in other colours

  function between(from, to, part) {
    const parts = (name) => [1, 3, 5].map((at) => parseInt(colour(name).replace(/^#(.)(.)(.)$/, "#$1$1$2$2$3$3").slice(at, at + 2), 16));
    const [a, b] = [parts(from), parts(to)];
    return `rgb(${a.map((value, k) => Math.round(value + part * (b[k] - value))).join(" ")})`;
  }

  const spans_decades = (column) => {
    const known = column.values.filter((value) => value !== null);
    return column.labels.length === 0 && known.length > 0 && Math.min(...known) > 0 && Math.max(...known) >= 20 * Math.min(...known);
  };

  // Of many columns two become the figure's series, by whether the run passed.
  function choose(figure, across, up) {
    figure.choice = [across, up];
    [figure.x, figure.y] = [figure.columns[across].name, figure.columns[up].name];
    figure.wide = [spans_decades(figure.columns[across]), spans_decades(figure.columns[up])];
    const x = figure.columns[across].values, y = figure.columns[up].values;
    figure.series = [1, 0].map((passed) => {
      const mine = x.map((_, k) => k).filter((k) => figure.passed[k] === passed && x[k] !== null && y[k] !== null);
      return { name: passed ? "passed" : "not passed", x: mine.map((k) => x[k]), y: mine.map((k) => y[k]) };
    });
  }

  function chooser(label, names, chosen, act) {
    const box = element("label", label + " "), list = element("select", "");
    names.forEach((each, i) => list.append(element("option", each, { value: i })));
    list.value = chosen;
    list.addEventListener("change", () => act(Number(list.value)));
    box.append(list);
    return box;
  }

  // Classes of a column: its values where they are few, else ten of equal width.
  function classes(column) {
    const name = (value) => column.labels[value] ?? short(value);
    const values = [...new Set(column.values.filter((value) => value !== null))].sort((a, b) => a - b);
    if (values.length <= 12) return { names: values.map(name), of: (value) => values.indexOf(value) };
    const many = 10, wide = spans_decades(column), scale = wide ? Math.log10 : (value) => value;
    const least = scale(values[0]), step = (scale(values[values.length - 1]) - least) / many;
    const edge = (k) => tick(Number((wide ? 10 ** (least + k * step) : least + k * step).toPrecision(3)));
    return { names: Array.from({ length: many }, (_, k) => `from ${edge(k)}`), of: (value) => Math.min(many - 1, Math.floor((scale(value) - least) / step)) };
  }

  // A table over two axes: the share of runs that passed, or the mean of a metric.
  function heat(box) {
    const figure = figures[box.dataset.columns], columns = figure.columns, [from, to] = figure.axes;
    const axes = columns.map((_, i) => i).filter((i) => i >= from && i < to), rest = columns.map((_, i) => i).filter((i) => i < from || i >= to);
    const names = axes.map((i) => columns[i].name), first = Math.max(0, axes.indexOf(figure.choice[0]));
    const chosen = { across: first, down: first === 0 && axes.length > 1 ? 1 : 0, value: 0 };
    const tools = element("div", "", { class: "tools" }), place = element("div", "", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Heat map" });
    const chooses = (label, list, key) => tools.append(chooser(label, list, chosen[key], (value) => { chosen[key] = value; fill(); }));
    chooses("Across", names, "across");
    chooses("down", names, "down");
    chooses("shown", ["share that passed", ...rest.map((i) => `mean of ${columns[i].name}`)], "value");
    box.append(element("h3", "Heat map over two axes"), tools, place);
    function fill() {
      const x = columns[axes[chosen.across]], y = columns[axes[chosen.down]], [across, down] = [classes(x), classes(y)];
      const values = chosen.value === 0 ? figure.passed : columns[rest[chosen.value - 1]].values;
      const cells = down.names.map(() => across.names.map(() => ({ sum: 0, runs: 0 })));
      x.values.forEach((at, k) => {
        if (at === null || y.values[k] === null || values[k] === null) return;
        const cell = cells[down.of(y.values[k])][across.of(at)];
        cell.sum += values[k];
        cell.runs += 1;
      });
      const means = cells.flat().filter((cell) => cell.runs > 0).map((cell) => cell.sum / cell.runs);
      const least = chosen.value === 0 ? 0 : Math.min(...means), greatest = chosen.value === 0 ? 1 : Math.max(...means);
      const table = element("table", ""), what = tools.querySelectorAll("select")[2].selectedOptions[0].textContent;
      table.append(element("caption", `${what}, and how many runs; across ${x.name}, down ${y.name}`));
      const head = table.createTHead().insertRow();
      head.append(element("td", ""), ...across.names.map((each) => element("th", each, { scope: "col", class: "n" })));
      const body = table.createTBody();
      cells.forEach((line, k) => {
        const row = body.insertRow();
        row.append(element("th", down.names[k], { scope: "row" }));
        for (const cell of line) {
          const mean = cell.sum / cell.runs, made = element("td", cell.runs > 0 ? `${Number(mean.toPrecision(3))} (${cell.runs})` : "", { class: "n" });
          const part = greatest > least ? (mean - least) / (greatest - least) : 1;
          if (cell.runs > 0) made.style.background = between("--back", "--line-1", 0.05 + 0.3 * part);
          row.append(made);
        }
      });
      place.replaceChildren(table);
    }
    fill();
    drawn.push(fill);
  }

  function draw(box) {
    if (box.plot) return;
    const figure = figures[box.dataset.figure];
    if (figure.columns) choose(figure, ...figure.choice);
    let log = figure.wide ? figure.wide[1] : figure.log, table = rows(figure, log), row = -1;
    const place = box.querySelector(".plot"), readout = box.querySelector(".readout");
    const plot = box.plot = new Dygraph(place, table, {
      ...options(figure, log),
      highlightCallback: (event, x, points, at, name) => {
        row = at;
        const one = figure.kind === "points" && points.find((p) => p.name === name);
        say(one ? `${lines(figure)[Number(name)].name}: ${figure.x} ${short(one.xval)}, ${figure.y} ${short(one.yval)}` : values_at(figure, x));
      },
    });
    function say(text) {
      readout.textContent = text;
      place.setAttribute("aria-valuetext", text);
      place.setAttribute("aria-valuenow", row);
    }
    function select(to) {
      row = Math.max(0, Math.min(table.length - 1, to));
      plot.setSelection(row);
      say(values_at(figure, table[row][0]));
    }
    function zoom(by) {
      const [left, right] = plot.xAxisRange(), middle = row < 0 ? (left + right) / 2 : table[row][0];
      plot.updateOptions({ dateWindow: [middle - by * (middle - left), middle + by * (right - middle)] });
    }
    const reset = () => plot.updateOptions({ dateWindow: options(figure, log).dateWindow ?? null, valueRange: options(figure, log).valueRange ?? null });
    const page = Math.max(1, Math.round(table.length / 20));
    const keys = {
      ArrowRight: () => select(row + 1), ArrowLeft: () => select(row - 1), PageDown: () => select(row + page), PageUp: () => select(row - page),
      Home: () => select(0), End: () => select(table.length - 1), "+": () => zoom(0.5), "-": () => zoom(2), "0": reset, Escape: reset,
    };
    place.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
    place.setAttribute("aria-valuemax", table.length - 1);
    const tools = box.querySelector(".tools");
    const button = (text, name, act) => tools.appendChild(element("button", text, { type: "button", "aria-label": `${name}: ${figure.title}` })).addEventListener("click", act);
    button("Whole", "Show the whole plot", reset);
    if (figure.kind !== "lanes" && figure.kind !== "points")
      button(log ? "Linear" : "Log", "Switch the logarithmic axis", (event) => {
        log = !log;
        table = rows(figure, log);
        event.target.textContent = log ? "Linear" : "Log";
        plot.updateOptions({ ...options(figure, log), file: table });
      });
    const choosing = (label, at) => tools.append(chooser(label, figure.columns.map((column) => column.name), figure.choice[at], (value) => {
      choose(figure, ...figure.choice.map((old, k) => k === at ? value : old));
      log = figure.wide[1];
      table = rows(figure, log);
      place.setAttribute("aria-valuemax", table.length - 1);
      row = -1;
      plot.updateOptions({ ...options(figure, log), dateWindow: null, file: table });
    }));
    if (figure.columns) ["Across", "up"].forEach(choosing);
    const link = tools.appendChild(element("a", "CSV", { href: `#${box.id}`, download: `${box.dataset.figure}.csv`, "aria-label": `Data as CSV: ${figure.title}` }));
    link.addEventListener("click", () => { link.href = "data:text/csv;charset=utf-8," + encodeURIComponent(csv(figure)); });
    drawn.push(() => plot.updateOptions({ colors: colours(figure), gridLineColor: colour("--grid"), axisLineColor: colour("--grid") }));
  }

  function sortable(table) {
    const body = table.tBodies[0];
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = element("button", head.textContent, { type: "button" });
      head.replaceChildren(button);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending";
        for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        const key = (row) => row.cells[column]?.title || (row.cells[column]?.textContent ?? "");
        const order = (a, b) => {
          const [x, y] = [parseFloat(key(a)), parseFloat(key(b))];
          return isNaN(x) || isNaN(y) ? key(a).localeCompare(key(b), "en") : x - y;
        };
        body.append(...[...body.rows].sort((a, b) => down ? order(b, a) : order(a, b)));
      });
    });
  }

  // At once: whoever prints the page or takes a picture of it does not wait.
  const boxes = [...document.querySelectorAll("figure[data-figure]")];
  boxes.forEach(draw);
  document.querySelectorAll("table.sortable").forEach(sortable);
  document.querySelectorAll(".heat").forEach(heat);

  const recolour = () => drawn.forEach((each) => each());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  // On paper a plot is scaled to the sheet: one that gets another size there is printed empty.
  const fit = () => boxes.forEach((box) => box.querySelector(".plot").style.setProperty("--drawn", box.plot.size().width));
  fit();
  addEventListener("beforeprint", () => { root.dataset.print = ""; fit(); recolour(); });
  addEventListener("afterprint", () => { delete root.dataset.print; recolour(); });
  root.dataset.ready = String(Math.round(performance.now()));
})();
