// Vectors of three numbers, as arrays.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
export const minus = (a, b) => a.map((x, i) => x - b[i])
// A point, moved by some lengths along directions.
export const along = (at, ...steps) =>
  at.map((x, i) => steps.reduce((sum, [length, way]) => sum + length * way[i], x))
export const cross = (a, b) => [0, 1, 2].map((k) => {
  const [i, j] = [(k + 1) % 3, (k + 2) % 3]
  return a[i] * b[j] - a[j] * b[i]
})
export const unit = (v) => v.map((x) => x / (Math.hypot(...v) || 1))

// The directions to the right and up on the screen, of length 1.
export function across(ahead, above = [0, 1, 0]) {
  const right = unit(cross(ahead, above))
  return {right, up: cross(right, unit(ahead))}
}

/**
 * A point on the other side of a plane: its normal, of length 1, and its distance from 0.
 * @param {Vector} point @param {number[]} plane
 */
export function reflected(point, [a, b, c, distance]) {
  return along(point, [2 * (distance - dot(point, [a, b, c])), [a, b, c]])
}

// Two directions in a plane, at right angles; level and upright where that can be.
export function spanned(normal) {
  const u = unit(Math.abs(normal[1]) > 0.99 ? [1, 0, 0] : cross([0, 1, 0], normal))
  return [u, cross(normal, u)]
}

// A direction, turned about an axis of length 1 (Rodrigues).
export function rotated(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)]
  return along(v.map((x) => x * c), [s, cross(axis, v)], [dot(v, axis) * (1 - c), axis])
}
