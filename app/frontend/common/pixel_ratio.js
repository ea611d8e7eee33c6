// Another pixel ratio, as on another screen or after a zoom: often the canvas keeps its size.

// Calls a function at each change; what is returned ends that.
export function onPixelRatio(act) {
  const watch = () => {
    const query = matchMedia(`(resolution: ${devicePixelRatio}dppx)`)
    query.addEventListener("change", changed)
    return () => query.removeEventListener("change", changed)
  }
  const changed = () => { forget(); forget = watch(); act() }
  let forget = watch()
  return () => forget()
}
