// Arrays as they come from the server, made into what scripts here and vtk.js know.

// Arrays arrive as Bokeh's own subclasses, whose names vtk.js does not know.
export function plain(array) {
  const base = Object.getPrototypeOf(array.constructor)
  const Type = base.name && base.name !== "TypedArray" && base !== Function.prototype
    ? base : array.constructor
  return new Type(array.buffer, array.byteOffset, array.length)
}

export function plainList(values) {
  return Array.from(values)
}
