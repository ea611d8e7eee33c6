// A part of a flat section, which a person sees and clicks from near.

const CELLS = 3  // that are seen from near, on each side
export const CLICK_RADIUS = 26  // pixels from the pointer to a node

// The box of the whole plane, or of some cells around a node.
export function around({data: {box, nodes, resolution}}, node, isNear) {
  if (!isNear || node < 0) { return box }
  const [x, y] = nodes[node]
  const half = CELLS / resolution
  return [x - half, y - half, x + half, y + half]
}

// The button that shows a part, or all.
export const closer = (mode) =>
  [mode.isNear ? "Whole plane" : "Closer", () => { mode.isNear = !mode.isNear }]
