// Where a ray from the eye meets a surface, and what the scene tells of that place.

// The triangle of a figure that is first met under a place of the canvas; null beside it.
function hitSurface(stage, figure, x, y, cut) {
  if (!figure.visible || figure.kind !== "surface" || !figure.triangles) { return null }
  const {origin, direction} = stage.ray(x, y)
  const p = figure.posed()
  const t = figure.triangles
  const [ox, oy, oz] = origin
  const [dx, dy, dz] = direction
  let best = null
  for (let i = 0; i < t.length; i += 3) {
    const a = 3 * t[i], b = 3 * t[i + 1], c = 3 * t[i + 2]
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2]
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2]
    const qx = dy * vz - dz * vy, qy = dz * vx - dx * vz, qz = dx * vy - dy * vx
    const det = ux * qx + uy * qy + uz * qz
    if (det === 0) { continue }
    const sx = ox - p[a], sy = oy - p[a + 1], sz = oz - p[a + 2]
    const g = (sx * qx + sy * qy + sz * qz) / det
    if (g < 0 || g > 1) { continue }
    const rx = sy * uz - sz * uy, ry = sz * ux - sx * uz, rz = sx * uy - sy * ux
    const h = (dx * rx + dy * ry + dz * rz) / det
    if (h < 0 || g + h > 1) { continue }
    const far = (vx * rx + vy * ry + vz * rz) / det
    if (far <= 0 || (best && far >= best.far)) { continue }
    const at = [ox + far * dx, oy + far * dy, oz + far * dz]
    if (cut && figure.clipped && !keeps(cut, figure.slab, at)) { continue }
    const share = [1 - g - h, g, h]
    best = {far, at, point: t[i + share.indexOf(Math.max(...share))]}
  }
  return best
}

function keeps({origin, normal}, slab, at) {
  let before = 0
  for (let k = 0; k < 3; k++) { before += (at[k] - origin[k]) * normal[k] }
  return before <= 0 && !(slab > 0 && before < -slab)
}

// The line of a figure nearest to a place of the canvas, within reach.
function hitLine(stage, figure, x, y, reach) {
  if (!figure.visible || figure.kind !== "lines" || !figure.pairs) { return null }
  const p = figure.rest
  const view = stage.viewAt(x, y)
  const at = (i) => stage.project([p[3 * i], p[3 * i + 1], p[3 * i + 2]], view)
  let best = null
  for (let i = 0; i < figure.pairs.length; i += 2) {
    const a = at(figure.pairs[i]), b = at(figure.pairs[i + 1])
    if (!a || !b) { continue }
    const [distance] = toSegment(x, y, a, b)
    if (distance <= reach && (!best || distance < best.distance)) { best = {distance, cell: i / 2} }
  }
  return best && best.cell
}

function told(figure, index) {
  const {text, values, names} = figure.reading
  const value = (values || figure.values)?.[index]
  if (value === undefined || Number.isNaN(value)) { return null }
  if (names?.length) { return text + names[value] }
  return text + (Number.isInteger(value) ? value : value.toFixed(3))
}
