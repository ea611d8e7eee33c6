// All that the scripts use of Panel and Bokeh beyond their documented interface.
// tests/app/frontend/test_private.py names what a new version lacks.

// Arrays arrive as Bokeh's own subclasses, whose names vtk.js does not know.
export function plain(array) {
  const base = Object.getPrototypeOf(array.constructor)
  const Type = base.name && base.name !== "TypedArray" && base !== Function.prototype
    ? base : array.constructor
  return new Type(array.buffer, array.byteOffset, array.length)
}

// Calls a function when the server is gone; what is returned ends that.
export function onConnectionLost(act) {
  // A document forgets none of its listeners.
  globalThis.Bokeh?.documents.at(-1)?.on_event("connection_lost", () => act?.())
  return () => { act = null }
}

// What Panel has put beside a component: each is in a wrapper next to the component's own.
export function siblings(element) {
  const own = element.getRootNode().host?.parentNode
  const beside = [...own?.parentNode?.children || []].filter((one) => one !== own)
  return beside.map((wrapper) => wrapper.firstElementChild).filter(Boolean)
}

// The page: the outermost element with a shadow tree. Null where there is none.
export function pageRoot(element) {
  let root = element.getRootNode()
  while (root.host?.getRootNode().host) { root = root.host.getRootNode() }
  return root.host ? root : null
}

// Panel's React components tell the server every value that they were given by it, once they have
// drawn it (`react_component.ts`). If a newer one came meanwhile, the old one takes its place: in
// the browser, and for a choice also on the server. With this, they tell only what they themselves
// set.
const ECHO = "targetModel.setv({ [resolvedProp]: value })"
const STATE = "return [value, setValue]"

const OWN_STATE = `return [value, React.useCallback((next) => {
  const set = typeof next === "function" ? next(targetModel.attributes[resolvedProp]) : next
  setValue(set)
  if (!target.model.events.includes(resolvedProp)) { targetModel.setv({[resolvedProp]: set}) }
}, [])]`

export function withoutEcho(code) {
  if (!code.includes(ECHO) || !code.includes(STATE)) {
    console.warn("This Panel's components differ from those that cutcell knows")
    return code
  }
  return code.replace(ECHO, "").replace(STATE, OWN_STATE)
}

const component = globalThis.Bokeh?.Models.get("panel.models.esm.ReactComponent")?.prototype
if (component) {
  const written = component._render_code
  component._render_code = function () { return withoutEcho(written.call(this)) }
}
