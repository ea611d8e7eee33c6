// What this browser remembers of the page. A page in a sandboxed frame may remember nothing.

const PAGE = "cutcell page"

export function recall(name) {
  try { return localStorage.getItem(name) } catch { return null }
}

// The key of the page that this tab showed before it was loaded again; null after a link was
// followed. Frames of one tab share its storage: none of them could tell which page was its own.
export const pageBefore = findPage()

function findPage() {
  try {
    const [entry] = performance.getEntriesByType("navigation")
    const {type} = /** @type {PerformanceNavigationTiming} */ (entry)
    if (type === "navigate" || parent !== window) { sessionStorage.removeItem(PAGE) }
    return sessionStorage.getItem(PAGE)
  } catch { return null }
}

export function rememberPage(key) {
  if (parent !== window) { return }
  try { sessionStorage.setItem(PAGE, key) } catch { /* a reload begins with the address alone */ }
}

export function remember(name, value) {
  try { localStorage.setItem(name, value) } catch { /* nothing is remembered */ }
}
