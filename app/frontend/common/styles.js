// Rules from a .css file, by its path from the folder of all scripts, for elements that stand apart
// from the page's own.

// Returns a function that makes a new style element of them.
export async function stylesheet(name) {
  const answer = await fetch(new URL(`../${name}`, import.meta.url))
  if (!answer.ok) { throw new Error(`${name}: ${answer.status}`) }
  const rules = await answer.text()
  return () => Object.assign(document.createElement("style"), {textContent: rules})
}
