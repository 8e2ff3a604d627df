"use strict";
// The live page of a run. What it knows of the run is `seen`, filled by frames of the server; what it draws follows from that alone.
// One tab of a browser listens to the server and hands frames to the others: a browser opens six connections to a server, not ten.
(() => {
const token = new URLSearchParams(location.search).get("token") || "";
const $ = (id) => document.getElementById(id);
const most = 4000;             // points of a curve
const most_text = 65536;       // of a UART
const PARAMETERS = [["a1", "a1"], ["a2", "a2"], ["b1", "b1"], ["b2", "b2"], ["beta_rad", "beta_rad"]];
const FIELDS = [["a1", "amplitude of U", 0.01], ["a2", "amplitude of V", 0.01], ["b1", "offset of U", 0.01], ["b2", "offset of V", 0.01],
  ["beta_rad", "phase shift, rad", 0.01], ["noise.sigma", "noise, full scale", 0.0001], ["harmonics.u3_amplitude", "third harmonic of U", 0.001],
  ["speed", "speed, times the described one", 0.1]];
const BAD = new Set(["DIVERGED", "ALARM", "MIRROR", "FROZEN", "CLIP", "SAT", "ZERO", "EARLY", "CONFIG", "UNSETTLED", "PARITY", "MISFIT", "JUMP", "MISSED"]);

let seen = {samples: {}, text: {}};   // the newest frame, with all curves and texts
let dirty = false, asked = 0;

// ---- frames ----

function keep(points) {
  const mine = seen.samples, first = (points.t || [])[0];
  if (first === undefined) return;
  let from = (mine.t || []).length;
  while (from > 0 && mine.t[from - 1] >= first) --from;   // of another future
  for (const name of Object.keys(points)) {
    const column = (mine[name] || []).slice(0, from).concat(points[name]);
    mine[name] = column.length > most ? column.filter((_, i) => i % 2 === 0 || i > column.length - most / 4) : column;
  }
}

function take(frame, full) {
  const {samples, text, said, ...rest} = frame;
  if (full) seen = {samples: {}, text: {}};
  Object.assign(seen, rest);
  keep(samples || {});
  for (const [stream, more] of Object.entries(text || {})) seen.text[stream] = ((seen.text[stream] || "") + more).slice(-most_text);
  if ((said || []).length) $("said").textContent = said.join(" ");
  draw_soon();
}

const channel = new BroadcastChannel("capsoc view " + token);
channel.onmessage = ({data}) => {
  if (data.hello) { if (leads && seen.mode) channel.postMessage({frame: seen, full: true}); return; }
  take(data.frame, data.full);
};
let leads = false;
function listen() {
  leads = true;
  const events = new EventSource("events?token=" + encodeURIComponent(token));
  for (const kind of ["full", "update"])
    events.addEventListener(kind, (event) => {
      const frame = JSON.parse(event.data);
      take(frame, kind === "full");
      channel.postMessage({frame, full: kind === "full"});
      if (frame.mode === "ended") events.close();
    });
  events.onerror = () => { if (seen.mode !== "ended") $("line").textContent = "No connection to capsoc; trying again."; };
  return new Promise(() => {});
}
navigator.locks.request("capsoc view " + token, listen);
channel.postMessage({hello: true});

async function tell(what, more) {
  $("said").textContent = "";
  try {
    const answer = await fetch("do", {method: "POST", headers: {"X-Capsoc-Token": token}, body: JSON.stringify({do: what, ...more})});
    const body = await answer.json();
    if (answer.ok) asked = body.command; else $("said").textContent = body.error;
  } catch { $("said").textContent = "capsoc does not answer; has the run ended?"; }
}

// ---- drawing ----

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
function canvas_of(id) {
  const canvas = $(id), scale = Math.min(devicePixelRatio || 1, 2), width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale); canvas.height = Math.round(height * scale);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = "11px system-ui"; pen.lineWidth = 1.5;
  return [pen, width, height];
}
function circle(pen, x, y, r, style, dashes) {
  pen.strokeStyle = style; pen.setLineDash(dashes || []); pen.beginPath(); pen.arc(x, y, r, 0, 2 * Math.PI); pen.stroke(); pen.setLineDash([]);
}

// Cartesian points around the origin, `reach` at the edge.
function lissajous(id, xs, ys, reach, style) {
  const [pen, width, height] = canvas_of(id), half = Math.min(width, height) / 2 - 6, x0 = width / 2, y0 = height / 2, unit = half / reach;
  pen.strokeStyle = colour("--grid");
  pen.beginPath(); pen.moveTo(0, y0); pen.lineTo(width, y0); pen.moveTo(x0, 0); pen.lineTo(x0, height); pen.stroke();
  circle(pen, x0, y0, unit, colour("--mark"), [4, 4]);
  pen.fillStyle = style;
  for (let i = 0; i < xs.length; ++i) pen.fillRect(x0 + xs[i] * unit - 1, y0 - ys[i] * unit - 1, 2, 2);
  const last = xs.length - 1;
  if (last >= 0) { pen.beginPath(); pen.arc(x0 + xs[last] * unit, y0 - ys[last] * unit, 5, 0, 2 * Math.PI); pen.fill(); }
}

function nice(low, high) {
  const step = 10 ** Math.floor(Math.log10((high - low) / 2 || 1)), fine = (high - low) / step > 5 ? 2 * step : step, ticks = [];
  for (let tick = Math.ceil(low / fine) * fine; tick <= high; tick += fine) ticks.push(tick);
  return ticks;
}
// Lines over time; `log`: powers of ten. A dashed level for each truth.
function chart(id, series, levels, log) {
  const [pen, width, height] = canvas_of(id), left = 44, bottom = 18, t = seen.samples.t || [];
  const scaled = (v) => v === null || v === undefined || (log && !(Math.abs(v) > 0)) ? NaN : log ? Math.log10(Math.abs(v)) : v;
  const values = series.flatMap((s) => s.y.map(scaled)).concat(levels.map((l) => l.y)).filter(Number.isFinite);
  if (!values.length || t.length < 2) return;
  let low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  if (log) { low = Math.floor(Math.max(low, -7)); high = Math.ceil(high); }
  if (high - low < 1e-9) { low -= 0.5; high += 0.5; } else { const edge = (high - low) * 0.05; low -= edge; high += edge; }
  const t0 = t[0], t1 = Math.max(t[t.length - 1], t0 + 1e-9);
  const px = (x) => left + (x - t0) / (t1 - t0) * (width - left - 4), py = (y) => 4 + (high - y) / (high - low) * (height - bottom - 8);
  pen.strokeStyle = colour("--grid"); pen.fillStyle = colour("--soft"); pen.textAlign = "right"; pen.textBaseline = "middle"; pen.lineWidth = 1;
  for (const tick of log ? Array.from({length: Math.floor(high) - Math.ceil(low) + 1}, (_, i) => Math.ceil(low) + i) : nice(low, high)) {
    pen.beginPath(); pen.moveTo(left, py(tick)); pen.lineTo(width, py(tick)); pen.stroke();
    pen.fillText(log ? "1e" + tick : String(Number(tick.toPrecision(3))), left - 4, py(tick));
  }
  pen.textBaseline = "alphabetic";
  for (const x of [t0, (t0 + t1) / 2, t1]) { pen.textAlign = x === t0 ? "left" : x === t1 ? "right" : "center"; pen.fillText(x.toFixed(1) + " s", px(x), height - 4); }
  pen.setLineDash([5, 4]);
  for (const level of levels) { pen.strokeStyle = level.style; pen.beginPath(); pen.moveTo(left, py(level.y)); pen.lineTo(width, py(level.y)); pen.stroke(); }
  pen.setLineDash([]); pen.lineWidth = 1.5;
  const now = (seen.state || {}).time_s;
  for (const {y, style} of series) {
    pen.strokeStyle = style; pen.beginPath();
    let up = true;
    y.forEach((value, i) => { const v = scaled(value); if (!Number.isFinite(v)) { up = true; return; } if (up) pen.moveTo(px(t[i]), py(v)); else pen.lineTo(px(t[i]), py(v)); up = false; });
    pen.stroke();
  }
  if (now < t1) { pen.strokeStyle = colour("--text"); pen.beginPath(); pen.moveTo(px(now), 0); pen.lineTo(px(now), height - bottom); pen.stroke(); }
}

// ---- the sensor's formula ----

/// (sine, cosine) of a sample with the parameters found when it was taken: U = a1 sin + b1, V = a2 cos(. + beta) + b2.
function calibrated(i) {
  const s = seen.samples, found = PARAMETERS.map(([name]) => s[name][i]);
  if (found.some((x) => x === null) || !(found[0] > 0.001) || !(found[1] > 0.001)) return null;
  const [a1, a2, b1, b2, beta] = found, sine = (s.u[i] - b1) / a1;
  return [sine, ((s.v[i] - b2) / a2 + sine * Math.sin(beta)) / Math.cos(beta)];
}
const wrap = (degrees) => ((degrees + 180) % 360 + 360) % 360 - 180;
const degrees = ([sine, cosine]) => (Math.atan2(sine, cosine) * 180 / Math.PI + 360) % 360;
const shown = (value, digits = 5) => Number.isFinite(value) ? Number(value.toPrecision(digits)).toString() : "-";

function until_now() {
  const t = seen.samples.t || [], now = (seen.state || {}).time_s;
  let end = t.length;
  while (end > 1 && t[end - 1] > now) --end;
  return end;
}

function draw_signals() {
  const s = seen.samples, end = until_now(), hz = Math.abs((((seen.sensor || {}).parameters || {}).frequency_hz)) || 0;
  let begin = Math.max(0, end - 500);
  if (hz) for (begin = Math.max(0, end - 1); begin > 0 && s.t[begin - 1] >= s.t[end - 1] - 2 / hz;) --begin;
  const u = (s.u || []).slice(begin, end), v = (s.v || []).slice(begin, end);
  lissajous("raw", u, v, 1.1, colour("--line-1"));
  const points = [];
  for (let i = begin; i < end; ++i) { const point = calibrated(i); if (point) points.push(point); }
  lissajous("calibrated", points.map((p) => p[0]), points.map((p) => p[1]), 1.6, colour("--line-3"));
  draw_dial(end - 1);
}

function draw_dial(i) {
  const [pen, width, height] = canvas_of("dial"), r = Math.min(width, height) / 2 - 8, s = seen.samples;
  circle(pen, width / 2, height / 2, r, colour("--mark"));
  if (i < 0) return;
  const point = calibrated(i), hand = (angle, style, length, thick) => {
    if (!Number.isFinite(angle)) return;
    const a = angle * Math.PI / 180;
    pen.strokeStyle = style; pen.lineWidth = thick; pen.beginPath(); pen.moveTo(width / 2, height / 2);
    pen.lineTo(width / 2 + r * length * Math.cos(a), height / 2 - r * length * Math.sin(a)); pen.stroke();
  };
  const truth = s.angle_deg[i] ?? NaN, found = s.found_deg[i] ?? (point ? degrees(point) : NaN);
  hand(truth, colour("--line-2"), 0.95, 6); hand(found, colour("--line-1"), 0.8, 2);
  $("angles").textContent = `True (thick) ${shown(truth)}, found (thin) ${shown(found)}, apart ${shown(wrap(found - truth), 3)} degrees` +
    (s.found_deg[i] === null ? "; the chip gives no angle, so this is what its parameters give" : "");
}

function draw_curves() {
  const s = seen.samples, truth = (seen.sensor || {}).parameters || {}, known = Object.keys(s).length > 0;
  const style = (i) => colour("--line-" + (i + 1));
  chart("parameters", known ? PARAMETERS.map(([name], i) => ({y: s[name], style: style(i)})) : [],
    PARAMETERS.flatMap(([, name], i) => Number.isFinite(truth[name]) ? [{y: truth[name], style: style(i)}] : []), false);
  const errors = known ? s.t.map((_, i) => { const p = calibrated(i); return p && s.angle_deg[i] !== null ? wrap(degrees(p) - s.angle_deg[i]) : null; }) : [];
  chart("errors", known ? [{y: errors, style: style(0)}, {y: s.error_deg, style: style(1)}, {y: s.error_average, style: style(2)}] : [], [], true);
  const last = until_now() - 1;
  rows("values", PARAMETERS.map(([name, true_name], i) => {
    const found = known && last >= 0 ? s[name][last] ?? NaN : NaN, right = truth[true_name] ?? NaN;
    return [name, shown(found), shown(right), shown(found - right, 3)];
  }));
}

// ---- the time line ----

const row_height = 24, axis_height = 18;
let spot = null;   // what the pointer or the keyboard is at: {name, ps}
let grid = null;   // where the last drawing put things
const UNITS = [[1e12, "s"], [1e9, "ms"], [1e6, "µs"], [1e3, "ns"]];
function duration(ps) {
  const [size, unit] = UNITS.find(([least]) => ps >= least) || UNITS[3];
  return `${Number((ps / size).toPrecision(6))} ${unit}`;
}
const at_time = (ps, digits = 9) => (ps / 1e12).toFixed(digits) + " s";

/// The bars of a row: begin and end in ps, and the share of that time, 1 for a single one.
function bars_of(row, line) {
  const bars = [], {slices, shares} = row;
  for (let i = 0; slices && i < slices.length; i += 2) bars.push([line.begin_ps + slices[i], line.begin_ps + slices[i] + slices[i + 1], 1]);
  (shares || []).forEach((share, i) => { if (share) bars.push([line.begin_ps + i * line.bin_ps, Math.min(line.begin_ps + (i + 1) * line.bin_ps, line.end_ps), share / 255]); });
  return bars;
}
/// The index of the bar that is nearest to a time; -1: there is none.
function nearest(bars, ps) {
  const apart = ([begin, end]) => ps < begin ? begin - ps : ps > end ? ps - end : 0;
  return bars.reduce((best, bar, i) => best < 0 || apart(bar) < apart(bars[best]) ? i : best, -1);
}
function told_of(row, bar) {
  const [begin, end, share] = bar;
  if (row.slices) return `${row.name}: from ${at_time(begin)}, ${end >= grid.line.end_ps ? "until now, " : ""}${duration(end - begin)} long`;
  const percent = share < 1.5 / 255 ? "less than 0.4" : shown(share * 100, 3);
  return `${row.name}: ${percent} % of the ${duration(end - begin)} from ${at_time(begin, 6)}`;
}
const row_style = (row, handler) => colour(row.name === "asleep" ? "--mark" : row.name === "thread" ? "--line-3" : "--line-" + [1, 2, 4, 5][handler % 4]);
function fitting(pen, text, width) {
  let end = text.length;
  while (end > 1 && pen.measureText(text.slice(0, end) + (end < text.length ? "…" : "")).width > width + 0.5) --end;
  return end < text.length ? text.slice(0, end) + "…" : text;
}
function hatch(pen, x, y, width, height) {
  pen.save(); pen.beginPath(); pen.rect(x, y, width, height); pen.clip();
  pen.strokeStyle = colour("--grid"); pen.lineWidth = 1; pen.beginPath();
  for (let at = x - height; at < x + width; at += 8) { pen.moveTo(at, y + height); pen.lineTo(at + height, y); }
  pen.stroke(); pen.restore();
}

function draw_activity() {
  const line = seen.activity;
  if (!line || !line.rows) return;
  const canvas = $("activity"), height = line.rows.length * row_height;
  canvas.style.height = height + axis_height + "px";
  const [pen, width] = canvas_of("activity"), text = colour("--text"), soft = colour("--soft");
  const widest = Math.min(Math.max(...line.rows.map((row) => pen.measureText(row.name).width)), width * 0.3), left = Math.ceil(widest) + 8;
  const first = line.begin_ps, all = Math.max(line.window_s * 1e12, line.end_ps - first);
  const px = (ps) => left + Math.max(0, ps - first) / all * (width - left - 1);
  const own = line.rows.filter((row) => row.exception === null).length;
  grid = {line, rows: line.rows.map((row, i) => ({row, bars: bars_of(row, line), style: row_style(row, i - own)})),
    ps: (x) => first + (x - left) / (width - left - 1) * all, one: all / (width - left - 1), height};
  if (line.known_ps > first) hatch(pen, left, 0, px(line.known_ps) - left, height);
  pen.textBaseline = "middle"; pen.lineWidth = 1;
  grid.rows.forEach(({row, bars, style}, i) => {
    const bottom = (i + 1) * row_height - 3, most = row_height - 6;
    pen.strokeStyle = colour("--grid"); pen.beginPath(); pen.moveTo(left, bottom + 0.5); pen.lineTo(px(line.end_ps), bottom + 0.5); pen.stroke();
    pen.fillStyle = text; pen.textAlign = "left"; pen.fillText(fitting(pen, row.name, widest), 0, bottom - most / 2);
    pen.fillStyle = style;
    for (const [begin, end, share] of bars) {
      const tall = Math.max(2, share * most), edge = row.slices ? px : (ps) => Math.round(px(ps));
      pen.fillRect(edge(begin), bottom - tall, Math.max(1, edge(end) - edge(begin)), tall);
    }
  });
  pen.fillStyle = soft; pen.textBaseline = "alphabetic";
  const digits = Math.max(1, Math.ceil(2 - Math.log10(line.window_s)));
  for (const [share, side] of [[0, "left"], [0.5, "center"], [1, "right"]]) {
    pen.textAlign = side; pen.fillText(at_time(first + share * all, digits), left + share * (width - left - 1), height + axis_height - 4);
  }
  write_moment(pen, px);
  rows("parts", line.rows.map((row) => [row.name, `${shown(row.share * 100, 3)} %`, String(row.begun)]));
  canvas.dataset.window = line.window_s;
  if (document.activeElement !== $("window")) $("window").value = String(line.window_s);
}

/// What is at the spot, with a frame around it.
function write_moment(pen, px) {
  const i = spot ? grid.rows.findIndex((each) => each.row.name === spot.name) : -1;
  const bars = i < 0 ? [] : grid.rows[i].bars, at = i < 0 ? -1 : nearest(bars, spot.ps);
  if (at < 0) { set("moment", i >= 0 ? `${spot.name}: not in this window` : "Point at a bar, or move with the arrow keys."); return; }
  const [begin, end] = bars[at];
  pen.strokeStyle = colour("--text"); pen.lineWidth = 1.5;
  pen.strokeRect(px(begin) - 1.5, i * row_height + 1.5, Math.max(1, px(end) - px(begin)) + 3, row_height - 3);
  set("moment", told_of(grid.rows[i].row, bars[at]));
}

function point_at(event) {
  if (!grid) return;
  const box = $("activity").getBoundingClientRect(), row = grid.rows[Math.floor((event.clientY - box.top) / row_height)];
  const ps = grid.ps(event.clientX - box.left), i = row ? nearest(row.bars, ps) : -1;
  const close = i >= 0 && row.bars[i][0] - ps < 5 * grid.one && ps - row.bars[i][1] < 5 * grid.one;
  spot = close ? {name: row.row.name, ps: (row.bars[i][0] + row.bars[i][1]) / 2} : null;
  draw_soon();
}

/// Arrow keys: along a row, or to the nearest bar of another one.
function move_spot(event) {
  const keys = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0], Home: [0, -Infinity], End: [0, Infinity]};
  const move = keys[event.key];
  if (!move || !grid || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  let i = Math.max(0, grid.rows.findIndex((each) => spot && each.row.name === spot.name));
  const ps = spot ? spot.ps : grid.line.end_ps, was_there = spot !== null;
  i = Math.min(Math.max(0, i + move[0]), grid.rows.length - 1);
  const {row, bars} = grid.rows[i], at = nearest(bars, ps);
  const next = Math.min(Math.max(0, at + (was_there || !Number.isFinite(move[1]) ? move[1] : 0)), bars.length - 1);
  spot = {name: row.name, ps: bars.length ? (bars[next][0] + bars[next][1]) / 2 : ps};
  draw_soon();
}

// ---- texts ----

function set(id, text) { const node = typeof id === "string" ? $(id) : id; if (node.textContent !== text) node.textContent = text; }
function rows(id, all) {
  const body = $(id).tBodies[0];
  while (body.rows.length > all.length) body.deleteRow(-1);
  all.forEach((cells, i) => {
    const row = body.rows[i] || body.insertRow();
    cells.forEach((cell, c) => set(row.cells[c] || row.insertCell(), cell));
  });
}
function options(select, names, chosen) {
  if (select.options.length !== names.length) select.replaceChildren(...names.map((name) => new Option(name, name)));
  if (chosen && document.activeElement !== select && select.value !== chosen) select.value = chosen;
}

function write_verdict() {
  const fields = (name) => Object.entries((seen[name] || {}).fields || {});
  const bits = [...fields("status"), ...fields("flags").map(([name, value]) => ["flag " + name, value])];
  const list = $("verdict");
  if (list.children.length !== bits.length) list.replaceChildren(...bits.map(() => document.createElement("li")));
  bits.forEach(([name, value], i) => { const li = list.children[i]; set(li, `${name} ${value}`); li.className = (value ? "on" : "") + (value && BAD.has(name.replace("flag ", "")) ? " bad" : ""); });
  if (seen.finished) {
    $("result").hidden = false;
    set("result", [...seen.finished.reports, `exit code ${seen.finished.code}: ${seen.finished.reason}`, seen.finished.table, ...seen.finished.lost].join("\n"));
  }
}

function write_texts() {
  if (seen.mode === undefined) return;  // nothing has come yet
  const state = seen.state || {}, mode = seen.mode || "", stands = mode !== "running" && mode !== "waiting", open = mode !== "ended";
  const rate = seen.host_s > 0 ? `, ${shown(state.time_s / seen.host_s, 3)} simulated seconds a second of work` : "";
  set("line", `${mode}: ${(state.time_s || 0).toFixed(3)} s, ${state.samples || 0} samples${rate}${seen.reason ? "; " + seen.reason : ""}`);
  set("play", stands ? "Run" : "Pause");
  $("play").disabled = !open || mode === "over";
  for (const id of ["sample", "turn"]) $(id).disabled = !open || mode === "over";
  $("end").disabled = !open;
  const past = $("past"), history = seen.history || {};
  past.min = history.beginning_s || 0; past.max = Math.max(history.end_s || 0, state.time_s || 0, 1e-3);
  if (document.activeElement !== past || !stands) past.value = state.time_s || 0;
  set("time", `${(state.time_s || 0).toFixed(6)} s; the history has ${shown(history.beginning_s || 0)} to ${shown(history.end_s || 0, 7)} s and ${history.inputs || 0} changes`);
  if (document.activeElement !== $("speed")) {
    const speed = String(seen.speed);
    if (![...$("speed").options].some((o) => o.value === speed)) $("speed").add(new Option(speed + "x", speed));
    $("speed").value = speed;
  }
  const streams = ["uart0", "uart1", "uart2", "uart3", "uart4", "itm", "semihosting"];
  options($("uart"), streams, null);
  const terminal = $("terminal"), text = seen.text[$("uart").value] || "";
  if (terminal.textContent !== text) { terminal.textContent = text; terminal.scrollTop = terminal.scrollHeight; }
  options($("peripheral"), seen.peripherals || [], seen.peripheral);
  rows("registers", (seen.registers || []).map((each) => [each.name, "0x" + each.value.toString(16).padStart(8, "0"),
    Object.entries(each.fields).map(([name, value]) => `${name}=${value}`).join(" ")]));
  const facts = {pc: "0x" + (state.pc || 0).toString(16), sleeps: state.asleep ? "yes" : "no", cycles: state.cycles, instructions: state.instructions,
    "cycles an instruction": shown(state.cycles / state.instructions, 4), "instructions a sample": shown(state.instructions / state.samples, 4)};
  const list = $("processor"), parts = Object.entries(facts).flat();
  if (list.children.length !== parts.length) list.replaceChildren(...parts.map((_, i) => document.createElement(i % 2 ? "dd" : "dt")));
  parts.forEach((part, i) => set(list.children[i], String(part ?? "-")));
  set("where", seen.place || (stands ? "" : "Pause the run to see the line and who called it."));
}

function write_story() {
  const story = seen.story, stands = seen.mode === "paused";
  $("story").hidden = !story;
  if (!story) return;
  set("chapter", `${story.title} (${story.step} of ${story.steps})`);
  set("tale", story.text);
  $("next").hidden = story.step >= story.steps;
  $("next").disabled = !stands;
}

/// A select has the run that is shown, until another one is chosen.
let shown_run = "";
function write_choices() {
  const {choices, run} = seen, fill = (id, pairs) => $(id).replaceChildren(...pairs.map(([value, text]) => new Option(text, value)));
  $("another").hidden = !choices;
  $("new").querySelector("button").disabled = seen.mode === "ended";
  const now = JSON.stringify([choices, run]);
  if (!choices || now === shown_run) return;
  shown_run = now;
  fill("new-story", [["", "none"], ...choices.stories.map(({name, title}) => [name, title])]);
  fill("new-program", choices.programs.map((name) => [name, name]));
  fill("new-arithmetic", [["", "as the story or the command line says"], ...choices.arithmetics.map((name) => [name, name])]);
  for (const name of ["story", "program", "arithmetic"]) $("new-" + name).value = run[name];
  set("now", ["story", "program", "arithmetic"].map((name) => `${name}: ${$("new-" + name).selectedOptions[0].text}`).join("; "));
}

function draw() {
  dirty = false;
  write_story(); write_choices();
  write_texts(); write_verdict(); draw_signals(); draw_curves(); draw_activity();
  document.documentElement.dataset.mode = seen.mode || "";
  document.documentElement.dataset.command = seen.command || 0;
}
function draw_soon() { if (!dirty) { dirty = true; requestAnimationFrame(draw); } }
addEventListener("resize", draw_soon);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw_soon);

// ---- controls ----

$("play").onclick = () => tell(seen.mode === "running" || seen.mode === "waiting" ? "pause" : "run");
$("next").onclick = () => tell("run");
$("sample").onclick = () => tell("sample");
$("turn").onclick = () => tell("turn");
$("end").onclick = () => tell("end");
$("reset").onclick = () => tell("reset");
$("speed").onchange = () => tell("speed", {factor: Number($("speed").value)});
$("past").onchange = () => tell("goto", {time_s: Number($("past").value)});
$("window").onchange = () => tell("activity", {window_s: Number($("window").value)});
$("new").onsubmit = (event) => {
  event.preventDefault();
  tell("new", {story: $("new-story").value, program: $("new-program").value, arithmetic: $("new-arithmetic").value});
};
$("activity").onpointermove = $("activity").onpointerdown = point_at;
$("activity").onkeydown = move_spot;
$("activity").onpointerleave = $("activity").onblur = () => { spot = null; draw_soon(); };
$("uart").onchange = draw_soon;
$("peripheral").onchange = () => tell("registers", {peripheral: $("peripheral").value});
$("send").onsubmit = (event) => {
  event.preventDefault();
  const uart = Number($("uart").value.slice(-1)) || 0;
  tell("uart", {uart, text: $("typed").value + "\r"});
  $("typed").value = "";
};
$("inject").onsubmit = (event) => { event.preventDefault(); tell("fault", {fault: $("fault").value}); };
$("faults").replaceChildren(...["flip coprocessor.cv[39]", "flip cpu.sp[5]", "flip mem:0x20000000[3]", "flip COPROCESSOR.STEP_AU[3]",
  "freeze sin for 2", "stuck1 cos[30] for 2", "lose sample for 0.1", "lose clock for 0.1", "lose irq coprocessor", "raise irq 3"].map((fault) => new Option(fault)));
for (const [key, label, step] of FIELDS) {
  const line = document.createElement("label"), input = document.createElement("input");
  Object.assign(input, {type: "number", step: "any", name: key});
  input.dataset.step = step;
  line.append(label, input);
  document.querySelector("#sensor .fields").append(line);
}
$("sensor").onsubmit = (event) => {
  event.preventDefault();
  const parameters = {};
  for (const input of $("sensor").querySelectorAll("input")) if (input.value !== "") parameters[input.name] = Number(input.value);
  if ("noise.sigma" in parameters) parameters["noise.seed"] = 1;
  if (Object.keys(parameters).length) tell("sensor", {parameters});
};
draw_soon();
document.documentElement.dataset.ready = "1";
})();
