// What this browser remembers of the page. A page in a sandboxed frame may remember nothing.

export function recall(name) {
  try { return localStorage.getItem(name) } catch { return null }
}

export function remember(name, value) {
  try { localStorage.setItem(name, value) } catch { /* nothing is remembered */ }
}
