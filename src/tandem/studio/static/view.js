/**
 * How the page is drawn: Preact and htm, with components that draw themselves anew whenever a signal
 * that they read has changed.
 * @module
 */
import { Component, html, render, useEffect, useLayoutEffect, useMemo, useRef, useState } from "./vendor/htm-preact.js";
import { batch, computed, effect, signal, untracked } from "./vendor/signals-core.js";

export { batch, computed, effect, html, render, signal, untracked, useEffect, useLayoutEffect, useMemo, useRef, useState };

/**
 * A button that opens a list of buttons, and closes it when one was chosen.
 * @param {{label: string, items: {key: string, label: string}[], choose: (key: string) => void}} props
 */
export function Menu({ label, items, choose }) {
  return html`<details
    class="menu"
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Escape" && /** @type {any} */ (event.currentTarget).removeAttribute("open")}
  >
    <summary>${label}</summary>
    <div>
      ${items.map(
        (item) => html`<button
          key=${item.key}
          onClick=${(/** @type {any} */ event) => {
            event.currentTarget.closest("details").removeAttribute("open");
            choose(item.key);
          }}
        >${item.label}</button>`,
      )}
    </div>
  </details>`;
}

/**
 * A text field whose text is the reader's own until it is committed by Enter or by leaving, so that
 * drawing anew never takes it away.
 * @param {{value: string, commit: (text: string) => void, [attribute: string]: unknown}} props
 */
export function Field({ value, commit, ...attributes }) {
  const [typed, setTyped] = useState(/** @type {string | null} */ (null));
  return html`<input
    ...${attributes}
    value=${typed ?? value}
    onInput=${(/** @type {any} */ event) => setTyped(event.currentTarget.value)}
    onChange=${(/** @type {any} */ event) => {
      commit(event.currentTarget.value);
      setTyped(null);
    }}
    onBlur=${() => setTyped(null)}
  />`;
}

/**
 * A component of `draw` that is drawn anew when its properties or the signals that it reads change,
 * and otherwise left alone.
 * @template P
 * @param {(props: P) => unknown} draw
 */
export function observed(draw) {
  return class extends Component {
    /** @type {(() => void) | undefined} */
    stop = undefined;

    /** @param {Record<string, unknown>} next @param {unknown} state */
    shouldComponentUpdate(next, state) {
      const keys = Object.keys(next);
      return (
        state !== this.state ||
        keys.length !== Object.keys(this.props).length ||
        keys.some((key) => next[key] !== this.props[key])
      );
    }

    /** @param {P} props */
    render(props) {
      this.stop?.();
      let drawn;
      let first = true;
      // The effect reads the signals once, for drawing; when one has changed it only asks to be
      // drawn anew, which makes a new effect.
      this.stop = effect(() => {
        if (first) {
          first = false;
          drawn = draw(props);
        } else this.setState({});
      });
      return drawn;
    }

    componentWillUnmount() {
      this.stop?.();
    }
  };
}
