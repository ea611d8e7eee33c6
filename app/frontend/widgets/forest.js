// Which rows of a tree are seen: some have others below them, and hide them or not.

const ALL_OPEN = 150

export class Forest {
  // `rows` in order, each behind its parent; `closed` holds the joints whose children are hidden.
  constructor(rows, closed) {
    this.rows = rows
    this.closed = closed
    this.at = new Map(rows.map((row, i) => [row.joint, i]))
  }

  hasChildren(i) { return this.rows[i + 1]?.level > this.rows[i].level }

  // The rows that are seen, as indices.
  seen() {
    const shown = []
    let below = Infinity
    for (let i = 0; i < this.rows.length; i++) {
      const {joint, level} = this.rows[i]
      if (level > below) { continue }
      below = this.closed.has(joint) ? level : Infinity
      shown.push(i)
    }
    return shown
  }

  parent(i) {
    let k = i - 1
    while (k >= 0 && this.rows[k].level >= this.rows[i].level) { k-- }
    return k
  }

  // Open all above a joint.
  reveal(joint) {
    for (let i = this.parent(this.at.get(joint) ?? 0); i >= 0; i = this.parent(i)) {
      this.closed.delete(this.rows[i].joint)
    }
  }
}

// A large skeleton begins with its first levels open only.
export function closedAtFirst(rows) {
  if (rows.length <= ALL_OPEN) { return new Set() }
  return new Set(rows.filter((row, i) => row.level > 2 && rows[i + 1]?.level > row.level)
    .map((row) => row.joint))
}
