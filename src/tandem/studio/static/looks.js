/**
 * One look for each operator, as in every other picture of the package: colour and pattern follow from
 * the operators of the cell alone. The classes stand in studio.css.
 * @module
 */

const PATTERNS = { human: 4, robot: 4, machine: 2 };

/**
 * @param {import("./ordered.js").Cell} cell
 * @returns {Map<string, {class: string, label: string, kind: string}>}
 */
export function looksOf(cell) {
  const seen = { human: 0, robot: 0, machine: 0 };
  return new Map(
    cell.operators.map((operator) => {
      const kind = operator.kind === "robot" || operator.kind === "machine" ? operator.kind : "human";
      const look = { class: `${kind}-${seen[kind]++ % PATTERNS[kind]}`, label: String(operator.label ?? operator.name), kind };
      return [operator.name, look];
    }),
  );
}
