/* The map of a sweep: a colour for each cell, its values under the pointer or the arrow keys, its command on click.
 * Data: the element #sweep (see fem/report/sweep_data.py). Cells are numbered as in table.csv: the last axis is the fastest.
 */
"use strict";
(() => {
  const sweep = JSON.parse(document.getElementById("sweep").textContent);
  const byId = (id) => document.getElementById(id);
  const canvas = byId("map"), pen = canvas.getContext("2d");
  const shown = byId("quantity"), across = byId("across"), up = byId("up");
  const INK = "#1c2330", QUIET = "#55606f", MARK = "#c2410c";

  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
  const sizes = sweep.axes.map((axis) => axis.values.length);
  const strides = sizes.map((_, k) => sizes.slice(k + 1).reduce((a, b) => a * b, 1));
  const columns = Object.fromEntries(sweep.columns.map((column) => [column.name, { ...column,
    values: column.words ? new Uint8Array(bytes(column.values)) : new Float32Array(bytes(column.values)) }]));
  const outcome = columns.outcome, fell = sweep.outcomes.findIndex((one) => one.name === "overturned");

  const place = sizes.map(() => 0);      // index along every axis: the chosen cell
  const cellAt = (where) => where.reduce((sum, k, axis) => sum + k * strides[axis], 0);
  const axes = () => [Number(across.value), up ? Number(up.value) : -1];

  // ---- words ------------------------------------------------------------------------------------------------
  const figures = (value, digits = 4) => {
    if (typeof value !== "number") return String(value);
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size === 0 || (size >= 1e-3 && size < 1e6)) return String(Number(value.toPrecision(digits))).replace("-", "−");
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const power = String(Number(exponent)).replace(/./g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
    return `${mantissa.replace("-", "−")} × 10${power}`;
  };
  const withUnit = (text, unit) => (unit && text !== "–" ? `${text} ${unit}` : text);
  const valueOf = (column, cell) => {
    if (column.words) return sweep.outcomes[column.values[cell]].label;
    const value = column.values[cell];
    if (column.names) return column.names[value];
    return withUnit(figures(value * column.factor), column.unit);
  };
  const quoted = (text) => (/^[\w.+\-=,/]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const commandOf = (cell) => {
    const changes = sweep.axes.map((axis, k) => [axis.key, axis.values[Math.floor(cell / strides[k]) % sizes[k]]])
      .filter(([key]) => !key.startsWith("free."))  // no key of a case
      .concat(sweep.derived.map((one) => [one.key, one.values[cell]]))
      .filter(([, value]) => value !== null);
    return [sweep.command, ...changes.map(([key, value]) => `--set ${quoted(`${key}=${value}`)}`)].join(" ");
  };

  // ---- colours ----------------------------------------------------------------------------------------------
  const scaleOf = (column) => {
    if (column.name === "rotation_ratio") return [0, 1];
    let low = Infinity, high = -Infinity;
    column.values.forEach((value, cell) => {
      if (Number.isFinite(value) && outcome.values[cell] !== fell) { low = Math.min(low, value); high = Math.max(high, value); }
    });
    return high > low ? [low, high] : [low, low + 1];
  };
  const paint = (column, scale, cell) => {
    const word = sweep.outcomes[outcome.values[cell]];
    if (column.words || !word.found || (outcome.values[cell] === fell && !column.names)) return word.colour;
    if (column.names) return column.colours[column.values[cell]];
    const share = (column.values[cell] - scale[0]) / (scale[1] - scale[0]);
    if (!Number.isFinite(share)) return "#ffffff";
    return sweep.colours[Math.round(Math.min(Math.max(share, 0), 1) * (sweep.colours.length - 1))];
  };

  // ---- the map ----------------------------------------------------------------------------------------------
  let frame = null;                      // where the cells lie: left, top, width, height of one, counts
  const draw = () => {
    const ratio = window.devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    canvas.width = Math.round(wide * ratio); canvas.height = Math.round(high * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    const [a, b] = axes(), columnCount = sizes[a], rowCount = b < 0 ? 1 : sizes[b];
    const left = 62, right = 10, top = 10, bottom = 46;
    frame = { left, top, a, b, columnCount, rowCount, w: (wide - left - right) / columnCount,
      h: Math.min((high - top - bottom) / rowCount, b < 0 ? 60 : Infinity) };
    const column = columns[shown.value], scale = column.words || column.names ? null : scaleOf(column), where = [...place];
    for (let i = 0; i < columnCount; i++) for (let j = 0; j < rowCount; j++) {
      where[a] = i; if (b >= 0) where[b] = j;
      const cell = cellAt(where), x = left + i * frame.w, y = top + (rowCount - 1 - j) * frame.h;
      const x0 = Math.round(x), y0 = Math.round(y);  // whole pixels: no seams between cells
      pen.fillStyle = paint(column, scale, cell);
      pen.fillRect(x0, y0, Math.round(x + frame.w) - x0, Math.round(y + frame.h) - y0);
    }
    ticks(a, columnCount, (i) => [left + (i + 0.5) * frame.w, top + rowCount * frame.h], true, wide);
    if (b >= 0) ticks(b, rowCount, (j) => [left, top + (rowCount - 0.5 - j) * frame.h], false, wide);
    marks(a, b);
    pen.strokeStyle = MARK; pen.lineWidth = 2.5;
    pen.strokeRect(left + place[a] * frame.w - 1, top + (b < 0 ? 0 : rowCount - 1 - place[b]) * frame.h - 1, frame.w + 2, frame.h + 2);
    legend(column, scale);
  };
  // Dotted lines at the values of the paper's example, between the middles of the cells beside them.
  const marks = (a, b) => {
    pen.strokeStyle = INK; pen.lineWidth = 1.5; pen.setLineDash([2, 3]);
    for (const [axis, horizontal] of [[a, true], [b, false]]) for (const mark of axis < 0 ? [] : sweep.axes[axis].marks) {
      const known = sweep.axes[axis].values, k = known.findIndex((value) => value >= mark * (1 - 1e-6));
      if (k < 0 || mark < known[0] * (1 - 1e-6)) continue;
      const at = 0.5 + (k === 0 ? 0 : k - Math.max(0, (known[k] - mark) / (known[k] - known[k - 1])));
      const x = frame.left + at * frame.w, y = frame.top + (frame.rowCount - at) * frame.h;
      pen.beginPath();
      if (horizontal) { pen.moveTo(x, frame.top); pen.lineTo(x, frame.top + frame.rowCount * frame.h); }
      else { pen.moveTo(frame.left, y); pen.lineTo(frame.left + frame.columnCount * frame.w, y); }
      pen.stroke();
    }
    pen.setLineDash([]);
  };
  // The labels that are shortest on the whole, so round ones where there are any: the first and every how manieth.
  const shortest = (words, least) => {
    let chosen = [0, least], cost = Infinity;
    for (let every = least; every <= 2 * least && 2 * every < words.length; every++) for (let first = 0; first < every; first++) {
      let sum = 0, shown = 0;
      for (let k = first; k < words.length; k += every) { sum += words[k].length; shown++; }
      if (sum / shown < cost) { cost = sum / shown; chosen = [first, every]; }
    }
    return chosen;
  };
  const ticks = (axis, count, at, horizontal, wide) => {
    const least = Math.max(1, Math.ceil(count / (horizontal ? Math.max(3, Math.floor(wide / 70)) : 14)));
    const words = sweep.axes[axis].values.map((one) => figures(one, 3));
    const [first, every] = shortest(words, least);
    pen.fillStyle = INK; pen.strokeStyle = QUIET; pen.lineWidth = 1; pen.font = "12px system-ui, sans-serif";
    for (let k = first; k < count; k += every) {
      const [x, y] = at(k), text = words[k];
      pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x - (horizontal ? 0 : 5), y + (horizontal ? 5 : 0)); pen.stroke();
      pen.textAlign = horizontal ? "center" : "right";
      pen.fillText(text, x - (horizontal ? 0 : 8), y + (horizontal ? 18 : 4));
    }
    const { label } = sweep.axes[axis];
    pen.font = "13px system-ui, sans-serif"; pen.textAlign = "center";
    if (horizontal) pen.fillText(label, frame.left + 0.5 * count * frame.w, frame.top + frame.rowCount * frame.h + 38);
    else {
      pen.save(); pen.translate(14, frame.top + 0.5 * count * frame.h); pen.rotate(-0.5 * Math.PI); pen.fillText(label, 0, 0); pen.restore();
    }
  };
  const legend = (column, scale) => {
    const box = byId("legend"); box.replaceChildren();
    const swatch = (colour, text) => {
      const item = document.createElement("span"), patch = document.createElement("span");
      patch.className = "swatch"; patch.style.background = colour; item.append(patch, text); box.append(item);
    };
    const [a, b] = axes();
    if ([a, b].some((axis) => axis >= 0 && sweep.axes[axis].marks.length)) box.append(`dotted: ${sweep.marked}`);
    if (column.names) { column.names.forEach((name, k) => { if (column.values.includes(k)) swatch(column.colours[k], name); }); return; }
    const seen = new Set(outcome.values);
    sweep.outcomes.forEach((one, k) => { if (seen.has(k) && (column.words || !one.found || k === fell)) swatch(one.colour, one.label); });
    if (scale) {
      const ramp = document.createElement("span");
      ramp.className = "ramp"; ramp.style.background = `linear-gradient(to right, ${sweep.colours.join(",")})`;
      ramp.style.flex = "0 1 9rem"; ramp.style.height = ".9rem";
      box.append(`${column.label}: ${figures(scale[0] * column.factor, 3)}`, ramp, withUnit(figures(scale[1] * column.factor, 3), column.unit));
    }
  };

  // ---- the chosen cell --------------------------------------------------------------------------------------
  const tell = (where, chosen) => {
    const cell = cellAt(where), body = byId("cell");
    body.replaceChildren(...sweep.axes.map((axis, k) => [axis.label, figures(axis.values[where[k]], 5)])
      .concat(Object.values(columns).map((column) => [column.label, valueOf(column, cell)])).map(([name, text]) => {
        const row = document.createElement("tr"), head = document.createElement("th"), data = document.createElement("td");
        head.scope = "row"; head.textContent = name; data.textContent = text; row.append(head, data); return row;
      }));
    const said = sweep.axes.map((axis, k) => `${axis.label} ${figures(axis.values[where[k]], 4)}`).join(", ");
    byId("cell-title").textContent = `Cell ${cell}${chosen ? "" : " (under the pointer)"}`;
    if (chosen) {
      byId("command").textContent = commandOf(cell);
      byId("said").textContent = `${said}: ${valueOf(outcome, cell)}, rotation ratio ${valueOf(columns.rotation_ratio, cell)}`;
    }
  };
  const choose = (where) => { where.forEach((k, axis) => { place[axis] = k; }); draw(); tell(place, true); };
  const under = (event) => {
    const box = canvas.getBoundingClientRect();
    const i = Math.floor((event.clientX - box.left - frame.left) / frame.w);
    const j = frame.rowCount - 1 - Math.floor((event.clientY - box.top - frame.top) / frame.h);
    if (i < 0 || i >= frame.columnCount || j < 0 || j >= frame.rowCount) return null;
    const where = [...place];
    where[frame.a] = i; if (frame.b >= 0) where[frame.b] = j;
    return where;
  };
  canvas.addEventListener("pointermove", (event) => { const where = under(event); if (where) tell(where, false); });
  canvas.addEventListener("pointerleave", () => tell(place, true));
  canvas.addEventListener("click", (event) => { const where = under(event); if (where) choose(where); });
  canvas.addEventListener("keydown", (event) => {
    const moves = { ArrowRight: [frame.a, 1], ArrowLeft: [frame.a, -1], ArrowUp: [frame.b, 1], ArrowDown: [frame.b, -1] };
    const [axis, step] = moves[event.key] || [-1, 0];
    if (event.key in moves && axis >= 0) {
      event.preventDefault();
      const where = [...place];
      where[axis] = Math.min(Math.max(where[axis] + step, 0), sizes[axis] - 1);
      choose(where);
    } else if (event.key === "Enter") { event.preventDefault(); copy(); }
  });
  const copy = async () => {
    const text = byId("command").textContent;
    try { await navigator.clipboard.writeText(text); byId("copied").textContent = "copied"; }
    catch {  // a page opened from a file may not reach the clipboard: select it, so that one key copies it
      getSelection().selectAllChildren(byId("command")); byId("copied").textContent = "selected: press Ctrl+C";
    }
    setTimeout(() => { byId("copied").textContent = ""; }, 4000);
  };
  byId("copy").addEventListener("click", copy);

  // ---- what is shown ----------------------------------------------------------------------------------------
  const others = () => {
    const [a, b] = axes(), box = byId("others");
    box.replaceChildren(...sweep.axes.map((axis, k) => ({ axis, k })).filter(({ k }) => k !== a && k !== b).map(({ axis, k }) => {
      const label = document.createElement("label"), list = document.createElement("select");
      axis.values.forEach((value, i) => list.add(new Option(figures(value, 5), i, false, i === place[k])));
      list.addEventListener("change", () => { const where = [...place]; where[k] = Number(list.value); choose(where); });
      label.append(`${axis.label} `, list); return label;
    }));
  };
  shown.addEventListener("change", draw);
  for (const [list, other] of [[across, up], [up, across]]) {
    if (list) list.addEventListener("change", () => {
      if (other && other.value === list.value) other.value = sweep.axes.findIndex((_, k) => String(k) !== list.value);
      others(); draw();
    });
  }
  new ResizeObserver(draw).observe(canvas);
  choose(sizes.map((size) => Math.floor(size / 2)));
  others();
})();
