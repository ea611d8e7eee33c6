// Keys of the widget library's menus: it opens them by the pointer alone, and its search field keeps
// the keys that choose and close.

const OPENING = ["Enter", " ", "ArrowDown", "ArrowUp"]
const CLOSED = "[role=combobox][aria-expanded=false]:not([aria-disabled=true])"
const ITEMS = "[role=menuitem]:not([aria-disabled=true]), [role=option]:not([aria-disabled=true])"
export const SEARCH = ".MuiMenu-list input[type=text]"

function press(event) {
  const target = event.composedPath()[0]
  if (event.ctrlKey || event.metaKey || event.altKey || !target.matches) { return }
  const act = target.matches(CLOSED) ? OPENING.includes(event.key) && (() => target.click())
    : target.matches(SEARCH) && ACTS[event.key]
  if (act) {
    event.preventDefault()
    event.stopImmediatePropagation()
    // Where the key is let go, the menu is open: the space would choose what has the focus there.
    if (event.key === " ") { addEventListener("keyup", swallow, {capture: true, once: true}) }
    act(target)
  }
}

function swallow(event) {
  event.preventDefault()
  event.stopImmediatePropagation()
}

// The item that contains the search field is none to choose.
function items(search) {
  const list = search.closest(".MuiMenu-list")
  return [...list.querySelectorAll(ITEMS)].filter((item) => !item.contains(search))
}

function match(search) {
  const all = items(search)
  return search.value ? all.find((item) => item.dataset.matched === "true")
    : all.find((item) => item.matches(".Mui-selected")) ?? all[0]
}

const ACTS = {
  Enter: (search) => match(search)?.click(),
  Escape: (search) => search.closest(".MuiInputBase-root").querySelector("button").click(),
  ArrowDown: (search) => {
    search.closest(".MuiMenu-list").removeEventListener("focusin", refocus)
    match(search)?.focus()
  },
}

// A search field has the focus when its menu opens: the library gives it to an item a moment later.
export function focusSearch(search) {
  search.setAttribute("aria-label", "Search")
  search.focus({preventScroll: true})
  search.select()
  search.closest(".MuiMenu-list").addEventListener("focusin", refocus, {once: true})
}

function refocus(event) {
  event.currentTarget.querySelector("input").focus({preventScroll: true})
}

addEventListener("keydown", press, true)
