// Where the legend stands: in its own corner, or in another while the character is behind it.

const FEWER = 0.5  // another corner must cover as small a part of what this one does
const SAMPLE = 6000  // points of the character that are looked at
const GAP = 6

export class LegendPlace {
  /**
   * `cards` tells what else stands over the canvas.
   * @param {Overlay} overlay @param {Renderer} renderer @param {() => Element[]} cards
   */
  constructor(overlay, renderer, cards) {
    this.overlay = overlay
    this.renderer = renderer
    this.cards = cards
    this.shift = [0, 0]
    this.corner = "bottom left"
  }

  // Where it would be in its own corner, on the page.
  get home() {
    const {left, right, top, bottom, width, height} = this.overlay.legend.getBoundingClientRect()
    const [x, y] = this.shift
    return {left: left - x, right: right - x, top: top - y, bottom: bottom - y, width, height}
  }

  // Called when the view rests.
  put() {
    const {legend, canvas} = this.overlay
    if (legend.hidden) { return }
    const [home, box] = [this.home, canvas.getBoundingClientRect()]
    const own = this.overlay.root.querySelectorAll(".tools, .transport, .painting-hint")
    const others = [...this.cards(), ...own]
      .map((card) => card.getBoundingClientRect()).filter(({width}) => width)
    const isFree = (place) => !others.some((other) => meets(place, other))
    const free = Object.entries(corners(home, box))
      .filter(([name, place]) => name === "bottom left" || isFree(place))
    const places = this.renderer.views.length > 1 ? free.slice(0, 1) : free
    const covered = places.map(([, place]) => this.behind(place, box))
    const now = places.findIndex(([name]) => name === this.corner)
    const [name, {left, top}] = places[freest(covered, Math.max(now, 0))]
    this.corner = name
    this.shift = [left - home.left, top - home.top]
    const [x, y] = this.shift
    legend.style.transform = name === "bottom left" ? "" : `translate(${x}px,${y}px)`
  }

  // How many points of the body are seen behind a place.
  behind({left, right, top, bottom}, box) {
    const body = this.renderer.actors.get("body")
    const points = body?.visible ? body.posed() : []
    const step = 3 * Math.max(Math.ceil(points.length / 3 / SAMPLE), 1)
    const project = this.renderer.projection()
    let count = 0
    for (let i = 0; i < points.length; i += step) {
      const pixel = project([points[i], points[i + 1], points[i + 2]])
      if (!pixel) { continue }
      const [x, y] = [pixel[0] + box.left, pixel[1] + box.top]
      if (x > left - GAP && x < right + GAP && y > top - GAP && y < bottom + GAP) { count += 1 }
    }
    return count
  }
}

// Positions of a card, as far from each edge as in its corner; its corner comes first.
export function corners({left, right, top, bottom}, box) {
  const [aside, below] = [left - box.left, box.bottom - bottom]
  const across = box.right - aside - right
  const up = box.top + below - top
  const moved = (x, y) => ({left: left + x, right: right + x, top: top + y, bottom: bottom + y})
  return {
    "bottom left": moved(0, 0), "bottom right": moved(across, 0), "top left": moved(0, up),
  }
}

// Which place to take: the first if nothing is behind it; else that of now, unless another is far
// better.
export function freest(covered, now) {
  if (!covered[0]) { return 0 }
  const least = covered.indexOf(Math.min(...covered))
  return covered[least] < FEWER * covered[now] ? least : now
}

export function meets(a, b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}
