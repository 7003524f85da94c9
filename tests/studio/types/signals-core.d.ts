// What the page uses of @preact/signals-core.
export interface Signal<T> {
  value: T;
  peek(): T;
}
export function signal<T>(value: T): Signal<T>;
export function computed<T>(compute: () => T): { readonly value: T; peek(): T };
export function effect(act: () => void): () => void;
export function batch<T>(act: () => T): T;
export function untracked<T>(read: () => T): T;
