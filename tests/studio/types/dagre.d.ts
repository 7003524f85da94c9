// What the page uses of @dagrejs/dagre.
export class Graph {
  [key: string]: any;
}
export function layout(graph: Graph): void;
