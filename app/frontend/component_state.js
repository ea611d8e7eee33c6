// Panel's React components tell the server every value that they were given by it, once they have
// drawn it. If a newer one came meanwhile, the old one takes its place: in the browser, and for a
// choice also on the server. With this, they tell only what they themselves set.

// Copied from Panel's `react_component.ts`.
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
