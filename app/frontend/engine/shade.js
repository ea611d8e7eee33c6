// The shaders of vtk.js, changed where an actor needs it: joints move its points (skin.js), and
// textures colour them (colour.js, materials.js).

import {colourShader} from "./colour.js"
import {MATERIAL_SHADER} from "./materials.js"
import {skinVertex} from "./skin.js"
import {FRAGMENT, replacements, VERTEX} from "./vtk_private.js"

// `needs`: how many sets of four influences, how many of a second skin, and what colours it.
export function shaderSwaps({sets, otherSets, by}) {
  const skin = skinVertex(sets, otherSets)
  const colour = by === "materials" ? MATERIAL_SHADER : colourShader(by, otherSets > 0)
  const begin = `${skin.declared}\n${colour.declared}\nvoid main()\n{\n${skin.main}\n${colour.main}`
  return replacements([[VERTEX.main, begin], ...skin.swaps], [...colour.fragment, ...MATT])
}

// Nothing here gleams, but vtk.js works it out for each light and pixel all the same.
const MATT = FRAGMENT.gleams.map((line) => [line, "if (false)"])
