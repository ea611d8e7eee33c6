// The shape of an actor: its points, cells and numbers of its points, in flat arrays.

// Corners of triangles as vtk.js keeps them: their number comes before each.
export function withCounts(cells) {
  const out = new Uint32Array(cells.length / 3 * 4)
  for (let i = 0, at = 0; i < cells.length; i += 3) {
    out[at++] = 3
    for (let c = 0; c < 3; c++) { out[at++] = cells[i + c] }
  }
  return out
}

export function boundsOf(points) {
  const b = [Infinity, -Infinity, Infinity, -Infinity, Infinity, -Infinity]
  for (let i = 0; i < points.length; i++) {
    const k = 2 * (i % 3)
    if (points[i] < b[k]) { b[k] = points[i] }
    if (points[i] > b[k + 1]) { b[k + 1] = points[i] }
  }
  return b
}

// The size of a box along each axis, and its middle.
export function boxOf(bounds) {
  const size = [0, 1, 2].map((i) => bounds[2 * i + 1] - bounds[2 * i])
  return {size, middle: size.map((length, i) => bounds[2 * i] + length / 2)}
}

// Puts others in the place of numbers, some at a place, at some places.
export function replace(numbers, size, places, others) {
  places.forEach((place, i) => {
    for (let k = 0; k < size; k++) { numbers[size * place + k] = others[size * i + k] }
  })
}

// Whether it must be seen whole; bones may reach far out of the character, above all those that
// move nothing.
export function isCharacter(actor) {
  return !actor.overlay
}
