// What the page uses of htm/preact/standalone.
export class Component<P = any, S = any> {
  constructor(props?: any);
  props: any; state: any;
  setState(state: any): void;
  [key: string]: any;
}
export function html(strings: TemplateStringsArray, ...values: any[]): any;
export function render(tree: any, parent: Element): void;
export function useEffect(act: () => void | (() => void), on?: unknown[]): void;
export function useLayoutEffect(act: () => void | (() => void), on?: unknown[]): void;
export function useMemo<T>(make: () => T, on?: unknown[]): T;
export function useRef<T>(first: T): { current: T };
export function useState<T>(first: T): [T, (next: T) => void];
