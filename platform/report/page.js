// Zooms the plots of a report, reads values out by mouse and by key, sorts tables.
// The plots stand in the page as SVG (drawing.cpp). This is no second renderer: it makes no curve, colour, dash or axis. For another window it
// gives the same paths and ticks other places, by the rule of scale.cpp and from the exact points. `tests/report` compares both, letter for letter.
// What comes from a result is text here, never markup.
"use strict";
(() => {
  const figures = JSON.parse(document.getElementById("figures").textContent);
  const root = document.documentElement;
  const short = (value) => String(Number(value.toPrecision(7)));

  // Six digits; an exponent below 1e-4 and from 1e6 on.
  function tick(value) {
    if (value === 0) return "0";
    const [digits, exponent] = value.toExponential(5).split("e").map(Number);
    return exponent < -4 || exponent >= 6 ? `${digits}e${exponent}` : String(Number(value.toPrecision(6)));
  }

  class Scale {
    constructor(log) { Object.assign(this, { log, least: Infinity, greatest: -Infinity }); }
    holds(value) { return Number.isFinite(value) && (!this.log || value !== 0); }
    shown(value) { return this.log ? Math.log10(Math.abs(value)) : value; }
    value(shown) { return this.log ? 10 ** shown : shown; }
    take(value) {
      if (!this.holds(value)) return;
      this.least = Math.min(this.least, this.shown(value));
      this.greatest = Math.max(this.greatest, this.shown(value));
    }
    close(margin, from_zero = false) {
      if (!(this.least <= this.greatest)) [this.least, this.greatest] = [0, 1];
      const at_zero = from_zero && this.least >= 0, middle = this.greatest / 2 + this.least / 2;
      let half = this.greatest / 2 - this.least / 2;
      if (half === 0) half = Math.max(Math.abs(this.least) / 10, 1e-300);
      half = Math.min(half * (1 + margin), Number.MAX_VALUE / 4);
      [this.least, this.greatest] = [at_zero ? 0 : middle - half, middle + half];
      return this;
    }
    part_of_shown(shown) {
      const part = (shown / 2 - this.least / 2) / (this.greatest / 2 - this.least / 2);
      return Math.min(Math.max(Number.isFinite(part) ? part : 0, -1000), 1000);
    }
    part(value) { return this.part_of_shown(this.shown(value)); }
    at(part) { return this.value(2 * (this.least / 2 + part * (this.greatest / 2 - this.least / 2))); }
    between(from, to) {
      const made = new Scale(this.log), [a, b] = [this.shown(from), this.shown(to)];
      return Object.assign(made, { least: Math.min(a, b), greatest: Math.max(a, b) });
    }
    ticks() {
      const range = this.greatest - this.least, all = [];
      if (this.log && range >= 2 && Number.isFinite(range)) {
        const step = Math.max(1, Math.ceil(range / 8));
        for (let at = Math.ceil(this.least / step) * step; at <= this.greatest; at += step) all.push({ part: this.part_of_shown(at), label: `1e${at}` });
        return all;
      }
      const [least, greatest] = [this.value(this.least), this.value(this.greatest)], wide = greatest - least;
      if (!(wide > 0) || !Number.isFinite(wide)) return all;
      let step = Number(`1e${Math.floor(Math.log10(wide / 5))}`);
      for (const factor of [2, 2.5, 2]) if (wide / step > 8) step *= factor;
      if (!(step > 0)) return all;
      const first = Math.ceil(least / step);
      for (let i = 0; i < 12 && (first + i) * step <= greatest; ++i) {
        const at = Math.abs((first + i) * step) < step * 1e-6 ? 0 : (first + i) * step;
        if (this.holds(at)) all.push({ part: this.part(at), label: tick(at) });
      }
      return all;
    }
  }

  const level = (figure, number, value) => value === null ? NaN : figure.kind === "lanes" ? number + 0.8 * value : value;
  const number = (value) => value ?? NaN;

  // The whole plot: all points and marks.
  function whole(figure, log) {
    const x = new Scale(figure.wide?.[0] ?? false), y = new Scale(log), bars = figure.kind === "bars", points = figure.kind === "points";
    figure.series.forEach((s, i) => {
      s.x.forEach((value) => x.take(number(value)));
      s.y.forEach((value) => y.take(level(figure, i, value)));
      for (const values of [s.low ?? [], s.high ?? []]) values.forEach((value) => y.take(number(value)));
    });
    figure.marks.forEach((mark) => y.take(mark.at));
    if (bars) [-0.5, figure.labels.length - 0.5].forEach((value) => x.take(value));
    if (bars) y.take(0);
    return { x: x.close(points ? 0.05 : 0), y: y.close(0.05, bars && !log) };
  }

  // What the points of a window, and the lines that enter it, take of the other axis.
  function fitted(figure, x, log) {
    const y = new Scale(log), bars = figure.kind === "bars";
    figure.series.forEach((s, i) => s.x.forEach((at, k) => {
      const inside = (j) => { const part = j < s.x.length && j >= 0 ? x.part(number(s.x[j])) : -1; return part >= 0 && part <= 1; };
      if (inside(k) || (!bars && figure.kind !== "points" && inside(k - 1)) || (!bars && figure.kind !== "points" && inside(k + 1))) [s.y[k], s.low?.[k], s.high?.[k]].forEach((value) => y.take(level(figure, i, value ?? null)));
    }));
    if (bars) y.take(0);
    return y.least <= y.greatest ? y.close(0.05, bars && !log) : null;
  }

  // The places of a series' points, as a path's data: for a bar's spread, too.
  function places(figure, i, { x, y }, wide, high) {
    const s = figure.series[i], across = (value) => Math.floor(x.part(value) * wide + 0.5), up = (value) => Math.floor((1 - y.part(value)) * high + 0.5);
    const pair = (command, a, b) => `${command}${a}${b < 0 ? "" : " "}${b}`;
    const steps = figure.kind === "steps" || figure.kind === "lanes", lone = s.x.length === 1;
    if (figure.kind === "bars") {
      const room = (x.part(1) - x.part(0)) * wide, each = 0.8 * room / figure.series.length, zero = y.log ? high : Math.min(Math.max(up(0), 0), high);
      const left = (k) => x.part(s.x[k]) * wide - 0.4 * room, thick = Math.max(Math.floor(each - 10 + 0.5), 5), known = s.x.map((_, k) => k).filter((k) => s.x[k] !== null);
      const spread = (k) => s.low && y.holds(number(s.low[k])) && y.holds(number(s.high[k]));
      return [known.filter((k) => y.holds(number(s.y[k]))).map((k) => `M${Math.floor(left(k) + i * each + 0.5)} ${zero}V${up(s.y[k])}h${thick}V${zero}z`).join(""),
        known.filter(spread).map((k) => `M${Math.floor(left(k) + (i + 0.5) * each + 0.5)} ${up(s.low[k])}V${up(s.high[k])}`).join("")];
    }
    const out = [];
    let down = false, last = [0, 0];
    s.x.forEach((at, k) => {
      const value = level(figure, i, s.y[k]);
      if (!y.holds(value) || !x.holds(number(at))) {
        down = down && y.log && s.y[k] === 0;
        return;
      }
      const [a, b] = [across(at), up(value)], by = [a - last[0], b - last[1]];
      if (figure.kind === "points") out.push(pair("M", a, b), "h0");
      else if (!down) out.push(pair("M", a, b));
      else out.push(steps ? `h${by[0]}v${by[1]}` : pair("l", ...by));
      last = [a, b];
      down = true;
    });
    if (lone && down && figure.kind !== "points") out.push("h0");
    return [out.join("")];
  }

  // What each line has nearest to x.
  const name_of_x = (figure, x) => figure.kind === "bars" ? figure.labels[Math.round(x)] ?? short(x) : `${figure.x} ${short(x)}`;
  function values_at(figure, x) {
    const parts = lines(figure).filter((s) => s.x.length > 0).map((s) => {
      let best = 0;
      s.x.forEach((at, k) => { if (Math.abs(at - x) < Math.abs(s.x[best] - x)) best = k; });
      return `${s.name}: ${s.y[best] === null ? "none" : short(s.y[best])}`;
    });
    return `${name_of_x(figure, x)}; ${parts.join("; ")}`;
  }

  // The data, then the marks from one end to the other.
  function lines(figure) {
    let least = Infinity, greatest = -Infinity;
    for (const s of figure.series)
      for (const x of s.x) { least = Math.min(least, x); greatest = Math.max(greatest, x); }
    const line = (mark) => ({ name: mark.label, x: least < greatest ? [least, greatest] : [least], y: [mark.at, mark.at] });
    return figure.series.concat(figure.marks.map(line));
  }

  // What keys go through: each x once, or each point of a cloud.
  function stops(figure) {
    if (figure.kind !== "points") return [...new Set(lines(figure).flatMap((s) => s.x))].sort((a, b) => a - b).map((x) => ({ x }));
    return figure.series.flatMap((s) => s.x.map((x, k) => ({ x, y: s.y[k], name: s.name }))).filter((p) => p.x !== null && p.y !== null).sort((a, b) => a.x - b.x);
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
          if (cell.runs > 0) made.style.background = `color-mix(in srgb, var(--line-1) ${Math.round(100 * (0.05 + 0.3 * part))}%, var(--back))`;
          row.append(made);
        }
      });
      place.replaceChildren(table);
    }
    fill();
  }

  const namespace = "http://www.w3.org/2000/svg";
  function shape(kind, attributes, text = "") {
    const made = document.createElementNS(namespace, kind);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
  }

  function live(box) {
    const figure = figures[box.dataset.figure];
    if (figure.columns) choose(figure, ...figure.choice);
    let log = figure.wide ? figure.wide[1] : figure.log, window = whole(figure, log), points = stops(figure), row = -1;
    const place = box.querySelector(".plot"), readout = box.querySelector(".readout"), svg = place.firstElementChild, area = svg.querySelector(".area");
    const [left, top, width, height] = ["x", "y", "width", "height"].map((key) => area[key].baseVal.value), floor = top + height;
    const ticks = svg.querySelector(".ticks"), overlay = svg.appendChild(shape("g", { class: "overlay" }));
    const curves = [...area.querySelectorAll(".curve")], spreads = figure.series.map((_, i) => curves[i].nextElementSibling).map((e) => e?.classList.contains("spread") ? e : null);
    const marks = [...area.querySelectorAll(".mark")], fixed = (value) => value.toFixed(1);

    // Moves curves, marks and ticks to where they are in the window.
    function show() {
      curves.forEach((curve, i) => {
        const [d, spread] = places(figure, i, window, width * 10, height * 10);
        curve.setAttribute("d", d);
        spreads[i]?.setAttribute("d", spread);
      });
      marks.forEach((mark, i) => mark.setAttribute("d", window.y.holds(figure.marks[i].at) ? `M0 ${Math.floor((1 - window.y.part(figure.marks[i].at)) * height * 10 + 0.5)}H${width * 10}` : ""));
      const made = [], line = (x1, y1, x2, y2) => made.push(shape("line", { x1: fixed(x1), y1: fixed(y1), x2: fixed(x2), y2: fixed(y2), class: "grid", stroke: "#d0d7de" }));
      const text = (x, y, words, more) => made.push(shape("text", { x: fixed(x), y: fixed(y), ...more }, words));
      if (figure.kind === "lanes") made.push(...[...ticks.querySelectorAll("text")].slice(0, figure.series.length));
      else for (const { part, label } of window.y.ticks()) {
        line(left, floor - part * height, left + width, floor - part * height);
        text(left - 6, floor - part * height + 4, label, { "text-anchor": "end" });
      }
      if (figure.kind === "bars") bar_labels(text);
      else for (const { part, label } of window.x.ticks()) {
        line(left + part * width, top, left + part * width, floor);
        text(left + part * width, floor + 16, label, { "text-anchor": "middle" });
      }
      ticks.replaceChildren(...made);
      mark_row();
    }
    function bar_labels(text) {
      const longest = Math.max(...figure.labels.map((label) => Math.min([...label].length, 18)), 0), from = Math.max(0, Math.ceil(window.x.at(0)));
      const shown = figure.labels.map((_, i) => i).filter((i) => i >= from && window.x.part(i) <= 1);
      const step = Math.floor(shown.length / (width / (6 * (longest + 2)))) + 1;
      for (let i = from; i < from + shown.length; i += step)
        text(left + window.x.part(i) * width, floor + 16, [...figure.labels[i]].slice(0, 18).join(""), { "text-anchor": "middle", "font-size": "10" });
    }
    // The line and the points that are read.
    function mark_row() {
      const stop = points[row], made = [];
      const circle = (x, y, i) => { if (window.y.holds(y) && window.x.part(x) >= 0 && window.x.part(x) <= 1 && window.y.part(y) >= 0 && window.y.part(y) <= 1) made.push(shape("circle", { cx: fixed(left + window.x.part(x) * width), cy: fixed(floor - window.y.part(y) * height), r: 4, class: curves[i]?.classList[1] ?? "" })); };
      if (stop && figure.kind === "points") circle(stop.x, stop.y, figure.series.findIndex((s) => s.name === stop.name));
      else if (stop && figure.kind !== "bars") figure.series.forEach((s, i) => { const k = s.x.indexOf(stop.x); if (k >= 0) circle(stop.x, level(figure, i, s.y[k]), i); });
      if (stop && figure.kind !== "points" && window.x.part(stop.x) >= 0 && window.x.part(stop.x) <= 1) {
        const x = fixed(left + window.x.part(stop.x) * width);
        made.unshift(shape("line", { x1: x, y1: top, x2: x, y2: floor }));
      }
      overlay.replaceChildren(...made);
    }
    function select(to) {
      if (points.length === 0) return;
      row = Math.max(0, Math.min(points.length - 1, to));
      const stop = points[row], text = stop.name === undefined ? values_at(figure, stop.x) : `${stop.name}: ${figure.x} ${short(stop.x)}, ${figure.y} ${short(stop.y)}`;
      readout.textContent = text;
      place.setAttribute("aria-valuetext", text);
      place.setAttribute("aria-valuenow", row);
      mark_row();
    }
    const go = (x, y) => { window = { x, y: y ?? fitted(figure, x, log) ?? window.y }; show(); };
    const reset = () => { window = whole(figure, log); show(); };
    function zoom(by) {
      const middle = row < 0 ? 0.5 : window.x.part(points[row].x);
      go(window.x.between(window.x.at(middle - by * middle), window.x.at(middle + by * (1 - middle))), figure.kind === "lanes" || figure.kind === "points" ? window.y : null);
    }
    const page = () => Math.max(1, Math.round(points.length / 20));
    const keys = {
      ArrowRight: () => select(row + 1), ArrowLeft: () => select(row - 1), PageDown: () => select(row + page()), PageUp: () => select(row - page()),
      Home: () => select(0), End: () => select(points.length - 1), "+": () => zoom(0.5), "-": () => zoom(2), "0": reset, Escape: reset,
    };
    place.addEventListener("keydown", (event) => {
      if (!keys[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });
    const size = () => { place.setAttribute("aria-valuemax", Math.max(0, points.length - 1)); };
    size();

    // By mouse: parts of the area, from its left lower corner.
    const spot = (event) => {
      const b = area.getBoundingClientRect(), inverse = svg.getScreenCTM().inverse(), p = new DOMPoint(event.clientX, event.clientY).matrixTransform(inverse);
      return b.width > 0 ? [(p.x - left) / width, (floor - p.y) / height] : [0, 0];
    };
    const clamped = (part) => Math.min(1, Math.max(0, part));
    let start = null;
    const dragged = (at) => Math.abs(at[0] - start[0]) * width >= Math.abs(at[1] - start[1]) * height ? 0 : 1;
    function nearest([across, up]) {
      const far = (p) => p.name === undefined ? Math.abs(window.x.part(p.x) - across) : Math.hypot(window.x.part(p.x) - across, window.y.part(p.y) - up);
      let best = 0;
      points.forEach((p, i) => { if (far(p) < far(points[best])) best = i; });
      return best;
    }
    place.addEventListener("pointermove", (event) => {
      const at = spot(event);
      if (start === null) return select(nearest(at));
      const axis = dragged(at), [a, b] = [start[axis], at[axis]].map(clamped).sort((one, other) => one - other);
      overlay.replaceChildren(shape("rect", axis === 0 ? { x: left + a * width, y: top, width: (b - a) * width, height } : { x: left, y: floor - b * height, width, height: (b - a) * height }));
    });
    place.addEventListener("pointerdown", (event) => {
      if (event.button !== 0 || event.pointerType === "touch") return;
      start = spot(event);
      place.setPointerCapture(event.pointerId);
    });
    place.addEventListener("pointerup", (event) => {
      if (start === null) return;
      const at = spot(event), axis = dragged(at), [a, b] = [start[axis], at[axis]].map(clamped).sort((one, other) => one - other);
      start = null;
      if ((b - a) * (axis === 0 ? width : height) < 4) return mark_row();
      if (axis === 0) go(window.x.between(window.x.at(a), window.x.at(b)), figure.kind === "lanes" || figure.kind === "points" ? window.y : null);
      else go(window.x, window.y.between(window.y.at(a), window.y.at(b)));
    });
    place.addEventListener("pointercancel", () => { start = null; mark_row(); });
    place.addEventListener("dblclick", reset);

    const tools = box.querySelector(".tools");
    const button = (text, name, act) => tools.appendChild(element("button", text, { type: "button", "aria-label": `${name}: ${figure.title}` })).addEventListener("click", act);
    button("Whole", "Show the whole plot", reset);
    const name_axes = () => {
      svg.querySelector(".x-name").textContent = figure.x;
      svg.querySelector(".y-name").textContent = log && figure.kind !== "bars" && !figure.columns ? figure.y.replace(/^(.*?)(, [^,]*)?$/, "|$1|$2") : figure.y;
    };
    if (figure.kind !== "lanes" && figure.kind !== "points")
      button(log ? "Linear" : "Log", "Switch the logarithmic axis", (event) => {
        log = !log;
        event.target.textContent = log ? "Linear" : "Log";
        name_axes();
        reset();
      });
    const choosing = (label, at) => tools.append(chooser(label, figure.columns.map((column) => column.name), figure.choice[at], (value) => {
      choose(figure, ...figure.choice.map((old, k) => k === at ? value : old));
      log = figure.wide[1];
      points = stops(figure);
      row = -1;
      size();
      name_axes();
      reset();
    }));
    if (figure.columns) ["Across", "up"].forEach(choosing);
    const link = tools.appendChild(element("a", "CSV", { href: `#${box.id}`, download: `${box.dataset.figure}.csv`, "aria-label": `Data as CSV: ${figure.title}` }));
    link.addEventListener("click", () => { link.href = "data:text/csv;charset=utf-8," + encodeURIComponent(csv(figure)); });
    // What a test asks.
    box.plot = { stops: () => points.length, x: () => [window.x.at(0), window.x.at(1)], y: () => [window.y.at(0), window.y.at(1)], log: () => [window.x.log, window.y.log], reset };
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

  [...document.querySelectorAll("figure[data-figure]")].forEach(live);
  document.querySelectorAll("table.sortable").forEach(sortable);
  document.querySelectorAll(".heat").forEach(heat);
  root.dataset.ready = String(Math.round(performance.now()));
})();
