// Shapes and rays that tests of the scripts share, the same at each run.

export function random(seed) {
  let state = seed >>> 0
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0
    return state / 2 ** 32
  }
}

// A ball with bumps: 2 n² triangles.
export function bumpy(n) {
  const points = new Float32Array(3 * (n + 1) * (n + 1))
  const triangles = []
  for (let i = 0; i <= n; i++) {
    for (let j = 0; j <= n; j++) {
      const [around, down] = [2 * Math.PI * i / n, Math.PI * j / n]
      const r = 1 + 0.2 * Math.sin(5 * around) * Math.sin(7 * down)
      const at = i * (n + 1) + j
      const flat = r * Math.sin(down)
      points.set([flat * Math.cos(around), r * Math.cos(down), flat * Math.sin(around)], 3 * at)
      if (i < n && j < n) { triangles.push(at, at + 1, at + n + 1, at + 1, at + n + 2, at + n + 1) }
    }
  }
  return {points, triangles: Uint32Array.from(triangles)}
}

// Rays from outside towards somewhere near the middle.
export function rays(count) {
  const next = random(11)
  const unit = (v) => v.map((x) => x / Math.hypot(...v))
  return Array.from({length: count}, () => {
    const origin = unit([next() - 0.5, next() - 0.5, next() - 0.5]).map((x) => 4 * x)
    const target = [next() - 0.5, next() - 0.5, next() - 0.5].map((x) => 2.5 * x)
    return [origin, unit(target.map((x, k) => x - origin[k]))]
  })
}
