/**
 * The task table, which feels like a spreadsheet: arrows, Tab, Enter, F2, ranges with Shift, blocks
 * copied from and pasted into other programs, fill down; what is wrong is said at its cell while one
 * types. Each of these is one step of undo.
 * @module
 */
import { FURTHER, cellOf, columnsOf, newTask, write } from "./columns.js";
import { cell, change, faults, say, typed } from "./state.js";
import { t } from "./words.js";
import { Menu, batch, computed, html, observed, signal, untracked, useLayoutEffect, useMemo, useRef } from "./view.js";

/** @typedef {import("./columns.js").Column} Column */
/** @typedef {import("./ordered.js").Cell} Cell */

/** Fields that were asked for beside those that tasks have. */
const asked = signal(/** @type {string[]} */ ([]));
export const columns = computed(() => columnsOf(cell.value, asked.value));
/** The range: where it was begun and where it ends, which is the active cell. */
const range = signal({ from: { row: 0, column: 0 }, to: { row: 0, column: 0 } });
const editing = signal(/** @type {{row: number, column: number, text: string} | null} */ (null));
/** Whether the active cell takes the focus when it moves. */
const focused = signal(false);

/** Per row, the messages of its columns. */
const messages = computed(() => {
  const rows = new Map((typed.value ?? cell.value).tasks.map((task, row) => [task.name, row]));
  /** @type {Map<number, Map<number, string[]>>} */
  const found = new Map();
  for (const fault of faults.value) {
    const at = cellOf(fault.place.map(String), columns.value, rows);
    if (!at) continue;
    const row = found.get(at.row) ?? new Map();
    found.set(at.row, row.set(at.column, [...(row.get(at.column) ?? []), fault.message]));
  }
  return found;
});

/** @param {number} row @param {number} column @param {boolean} [extend] */
export function goTo(row, column, extend = false) {
  const to = {
    row: Math.max(0, Math.min(cell.value.tasks.length - 1, row)),
    column: Math.max(0, Math.min(columns.value.length - 1, column)),
  };
  focused.value = true;
  range.value = { from: extend ? range.value.from : to, to };
}

function bounds() {
  const { from, to } = range.value;
  return {
    top: Math.min(from.row, to.row),
    bottom: Math.max(from.row, to.row),
    left: Math.min(from.column, to.column),
    right: Math.max(from.column, to.column),
  };
}

export const Table = observed(() => {
  const all = columns.value;
  const grid = useRef(/** @type {HTMLElement | null} */ (null));
  return html`
    <div class="heading">
      <h2>${t("table.title")}</h2>
      <span class="tools">
        <button onClick=${addTask}>${t("button.add_task")}</button>
        <button onClick=${deleteTasks} disabled=${cell.value.tasks.length === 0}>${t("button.delete_task")}</button>
        <${MoreColumns} />
      </span>
    </div>
    ${cell.value.tasks.length === 0 ? html`<p class="empty">${t("table.empty")}</p>` : null}
    <div class="sheet" ref=${grid} onCopy=${copy} onCut=${cut} onPaste=${paste}>
      <table role="grid" aria-label=${t("table.title")} aria-multiselectable="true" onKeyDown=${onKey}>
        <thead><tr>${all.map((column) => html`<th key=${column.id} scope="col" title=${column.hint} class=${column.kind}>${column.title}</th>`)}</tr></thead>
        <tbody onMouseDown=${onCell(press)} onMouseOver=${onCell(sweep)} onDblClick=${onCell((_, row, column) => beginEdit(row, column))}>
          ${cell.value.tasks.map((task, row) => html`<${Row} key=${row} task=${task} row=${row} columns=${all} />`)}
        </tbody>
      </table>
    </div>
    <${Focus} grid=${grid} />
  `;
});

const MoreColumns = observed(() => {
  const there = new Set(columns.value.map((column) => column.id));
  const rest = FURTHER.filter((key) => !there.has(key));
  if (rest.length === 0) return null;
  const items = rest.map((key) => ({ key, label: t(`column.${key}`) }));
  return html`<${Menu} label=${t("table.more")} items=${items} choose=${(/** @type {string} */ key) => (asked.value = [...asked.value, key])} />`;
});

/** @param {number} row @returns {string} what it shows of the range and of editing; changes only when that does. */
function paintOf(row) {
  const { top, bottom, left, right } = bounds();
  const { to } = range.value;
  const within = row >= top && row <= bottom ? `${left},${right}` : "";
  return `${within}|${to.row === row ? to.column : ""}|${editing.value?.row === row ? editing.value.column : ""}`;
}

const Row = observed((/** @type {{task: any, row: number, columns: Column[]}} */ { task, row, columns }) => {
  const paint = useMemo(() => computed(() => paintOf(row)), [row]);
  const said = useMemo(() => computed(() => JSON.stringify([...(messages.value.get(row) ?? [])])), [row]);
  const [within, active, edited] = paint.value.split("|");
  const [left, right] = within === "" ? [1, 0] : within.split(",").map(Number);
  const wrong = new Map(/** @type {[number, string[]][]} */ (JSON.parse(said.value)));
  return html`<tr>
    ${columns.map((column, place) => {
      const message = wrong.get(place)?.join("\n");
      const open = edited === String(place);
      const id = `fault-${row}-${place}`;
      return html`<td
        key=${column.id}
        role=${place === 0 ? "rowheader" : "gridcell"}
        class="${column.kind} ${place >= left && place <= right ? "within" : ""} ${active === String(place) ? "active" : ""} ${message ? "wrong" : ""}"
        tabindex=${active === String(place) ? 0 : -1}
        aria-selected=${place >= left && place <= right}
        aria-invalid=${message ? "true" : undefined}
        aria-describedby=${message ? id : undefined}
        data-row=${row}
        data-column=${place}
        >${open ? html`<${Editor} row=${row} column=${place} title=${column.title} />` : column.read(task)}${message
          ? html`<span class="message" id=${id}>${message}</span>`
          : null}</td
      >`;
    })}
  </tr>`;
});

const Editor = observed((/** @type {{row: number, column: number, title: string}} */ { row, column, title }) => {
  const field = useRef(/** @type {HTMLInputElement | null} */ (null));
  useLayoutEffect(() => {
    field.current?.focus();
  }, []);
  const text = untracked(() => editing.value?.text ?? "");
  return html`<input
    ref=${field}
    aria-label=${t("table.editor", { column: title, task: cell.value.tasks[row].name })}
    value=${text}
    spellcheck=${false}
    onInput=${(/** @type {any} */ event) => type(event.currentTarget.value)}
    onBlur=${() => endEdit(true)}
    onMouseDown=${(/** @type {Event} */ event) => event.stopPropagation()}
  />`;
});

/** Gives the focus to the active cell when it has moved. */
const Focus = observed((/** @type {{grid: {current: HTMLElement | null}}} */ { grid }) => {
  const { row, column } = range.value.to;
  editing.value; // when it ends, the focus goes back to the cell
  useLayoutEffect(() => {
    // Asked now, not when this was drawn: a key may have begun to edit since.
    if (!focused.peek() || editing.peek()) return;
    const active = /** @type {HTMLElement | null} */ (grid.current?.querySelector(`[data-row="${row}"][data-column="${column}"]`));
    if (active && document.activeElement !== active) active.focus();
    focused.value = false;
  });
  return null;
});

/** All that is wrong, with a way to its cell. */

// ---- editing one cell

/** @param {number} row @param {number} column @param {string} [text] what was typed to begin; otherwise what stands there. */
function beginEdit(row, column, text) {
  const held = columns.value[column].read(cell.value.tasks[row]);
  goTo(row, column);
  editing.value = { row, column, text: text ?? held };
  if (text !== undefined) type(text);
}

/** @param {string} text */
function type(text) {
  const now = editing.value;
  if (!now) return;
  now.text = text; // the field shows it already: nobody has to draw anew
  typed.value = write(cell.value, now.row, columns.value[now.column], text);
}

/** @param {boolean} keep */
function endEdit(keep) {
  const now = editing.value;
  if (!now) return;
  const next = keep ? write(cell.value, now.row, columns.value[now.column], now.text) : cell.value;
  batch(() => {
    editing.value = null;
    typed.value = null;
    if (next !== cell.value) change({ cell: next });
  });
}

/**
 * What is to be done where a cell was hit: one listener for all cells, since there may be thousands.
 * @param {(event: MouseEvent, row: number, column: number) => void} act
 */
function onCell(act) {
  return (/** @type {MouseEvent} */ event) => {
    const hit = /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest("td[data-row]"));
    if (hit) act(event, Number(hit.dataset.row), Number(hit.dataset.column));
  };
}

/** Extends the range to where the pressed mouse is. @param {MouseEvent} event @param {number} row @param {number} column */
function sweep(event, row, column) {
  const open = editing.value?.row === row && editing.value.column === column;
  if (event.buttons === 1 && !open) goTo(row, column, true);
}

/** @param {MouseEvent} event @param {number} row @param {number} column */
function press(event, row, column) {
  if (event.button !== 0) return;
  endEdit(true);
  goTo(row, column, event.shiftKey);
  event.preventDefault();
}

// ---- keys

/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1], PageUp: [-15, 0], PageDown: [15, 0] };

/** @param {KeyboardEvent} event */
function onKey(event) {
  const handled = editing.value ? keyWhileEditing(event) : keyOnCell(event);
  if (!handled) return;
  event.preventDefault();
  event.stopPropagation();
}

/** @param {KeyboardEvent} event @returns {boolean} */
function keyWhileEditing(event) {
  const { row, column } = range.value.to;
  if (event.key === "Escape") {
    endEdit(false);
    focused.value = true;
    range.value = { ...range.value };
  } else if (event.key === "Enter") {
    endEdit(true);
    goTo(row + (event.shiftKey ? -1 : 1), column);
    if (range.value.to.row === row) range.value = { ...range.value };
  } else if (event.key === "Tab") {
    endEdit(true);
    step(event.shiftKey ? -1 : 1);
  } else if ((event.key === "ArrowUp" || event.key === "ArrowDown") && !event.shiftKey) {
    endEdit(true);
    goTo(row + ARROWS[event.key][0], column);
  } else return (event.stopPropagation(), false);
  return true;
}

/** @param {KeyboardEvent} event @returns {boolean} */
function keyOnCell(event) {
  const { row, column } = range.value.to;
  const control = event.ctrlKey || event.metaKey;
  const last = { row: cell.value.tasks.length - 1, column: columns.value.length - 1 };
  if (ARROWS[event.key]) {
    const [down, right] = ARROWS[event.key];
    if (control) goTo(down ? (down < 0 ? 0 : last.row) : row, right ? (right < 0 ? 0 : last.column) : column, event.shiftKey);
    else goTo(row + down, column + right, event.shiftKey);
  } else if (event.key === "Home") goTo(control ? 0 : row, 0, event.shiftKey);
  else if (event.key === "End") goTo(control ? last.row : row, last.column, event.shiftKey);
  else if (event.key === "Tab") return step(event.shiftKey ? -1 : 1);
  else if (event.key === "Enter" && !control) goTo(row + (event.shiftKey ? -1 : 1), column);
  else if (event.key === "F2") beginEdit(row, column);
  else if (event.key === "Delete" || event.key === "Backspace") fill(() => "");
  else if (control && event.key.toLowerCase() === "d") fillDown();
  else if (control && event.key.toLowerCase() === "a") selectAll(last);
  else if (event.key.length === 1 && !control && !event.altKey) beginEdit(row, column, event.key);
  else return false;
  return true;
}

/** The next cell; Tab leaves the table at its ends. @param {number} by @returns {boolean} */
function step(by) {
  const { row, column } = range.value.to;
  const wide = columns.value.length;
  const to = row * wide + column + by;
  if (to < 0 || to >= wide * cell.value.tasks.length) return false;
  goTo(Math.floor(to / wide), to % wide);
  return true;
}

/** @param {{row: number, column: number}} last */
function selectAll(last) {
  range.value = { from: { row: 0, column: 0 }, to: last };
}

// ---- blocks

/** Writes a text into every cell of the range. @param {(row: number, column: number) => string} text */
function fill(text) {
  const { top, bottom, left, right } = bounds();
  let next = cell.value;
  for (let row = top; row <= bottom; row++)
    for (let column = left; column <= right; column++) next = write(next, row, columns.value[column], text(row, column));
  if (next !== cell.value) change({ cell: next });
}

function fillDown() {
  const { top, bottom, left } = bounds();
  if (top === bottom) return;
  const first = cell.value.tasks[top];
  // Names are unique, so a name is never filled down.
  fill((row, column) => columns.value[column].read(column === 0 && left === 0 ? cell.value.tasks[row] : first));
  say("status.filled", { n: bottom - top });
}

/** @returns {string} the range as other programs read it. */
function block() {
  const { top, bottom, left, right } = bounds();
  return cell.value.tasks
    .slice(top, bottom + 1)
    .map((task) => columns.value.slice(left, right + 1).map((column) => column.read(task)).join("\t"))
    .join("\n");
}

/** @param {ClipboardEvent} event */
function copy(event) {
  if (editing.value) return;
  event.clipboardData?.setData("text/plain", block());
  event.preventDefault();
}

/** @param {ClipboardEvent} event */
function cut(event) {
  if (editing.value) return;
  copy(event);
  fill(() => "");
}

/** @param {ClipboardEvent} event */
function paste(event) {
  if (editing.value) return;
  event.preventDefault();
  const text = event.clipboardData?.getData("text/plain") ?? "";
  const lines = text.replace(/\r\n?/g, "\n").replace(/\n$/, "").split("\n").map((line) => line.split("\t"));
  if (text === "") return;
  pasteAt(lines);
}

/** Writes a block from the top left of the range on; rows that are wanting are added. @param {string[][]} lines */
function pasteAt(lines) {
  const { top, left } = bounds();
  const all = columns.value;
  let tasks = [...cell.value.tasks];
  while (tasks.length < top + lines.length) tasks.push(newTask({ ...cell.value, tasks }));
  const wide = Math.min(Math.max(...lines.map((line) => line.length)), all.length - left);
  lines.forEach((line, down) => {
    for (let right = 0; right < Math.min(line.length, wide); right++)
      tasks[top + down] = all[left + right].write(tasks[top + down], unquoted(line[right]));
  });
  batch(() => {
    change({ cell: { ...cell.value, tasks } });
    range.value = { from: { row: top, column: left }, to: { row: top + lines.length - 1, column: left + Math.max(wide, 1) - 1 } };
    focused.value = true;
  });
  const lost = Math.max(...lines.map((line) => line.length)) - wide;
  say(lost > 0 ? "status.pasted_part" : "status.pasted", { rows: lines.length, columns: wide, lost });
}

/** @param {string} text a value as Excel copies it: quoted where it holds a break or a quote. */
function unquoted(text) {
  return /^".*"$/s.test(text) ? text.slice(1, -1).replaceAll('""', '"') : text;
}

function addTask() {
  change({ cell: { ...cell.value, tasks: [...cell.value.tasks, newTask(cell.value)] } });
  goTo(cell.value.tasks.length - 1, 0);
  say("status.added");
}

/** Deletes the tasks of the range, and what waited for them no longer does. */
function deleteTasks() {
  const { top, bottom } = bounds();
  const gone = new Set(cell.value.tasks.slice(top, bottom + 1).map((task) => task.name));
  const tasks = cell.value.tasks
    .filter((_, row) => row < top || row > bottom)
    .map((task) => {
      if (!Array.isArray(task.after) || !task.after.some((name) => gone.has(name))) return task;
      const { after, ...rest } = task;
      const left = after.filter((/** @type {string} */ name) => !gone.has(name));
      return left.length ? { ...task, after: left } : rest;
    });
  change({ cell: { ...cell.value, tasks } });
  goTo(top, range.value.to.column);
  say("status.deleted", { n: gone.size });
}
