// The part of Preact that the scripts use; all of it: https://preactjs.com/guide/v10/api-reference

export type Node = object | string | number | null | undefined | false | Node[]
export function h(tag: string, about?: Record<string, any> | null, ...children: Node[]): object
export function render(node: Node, parent: Element): void
