// A surface in the materials of the character's file, on the graphics card: each corner of its
// triangles has a tint, and a place in one of the images, which all actors share.

import {POINTS_WIDE, PointTexture} from "./colour.js"
import {plain} from "../common/panel.js"
import {FRAGMENT} from "./vtk_private.js"

const [CORNER_UNIT, TINT_UNIT, IMAGE_UNIT] = [10, 11, 12]  // colour.js takes those after them

// The images, all of one size: the layers of one texture.
export class ImageLayers {
  constructor(gl) {
    this.gl = gl
    this.set(null)
  }

  // `pixels`: red, green, blue, alpha of each, from the upper left corner.
  set(images) {
    const {gl} = this
    const {count, side, pixels} = images || {count: 0, side: 1}
    this.remove()
    this.texture = gl.createTexture()
    this.bind()
    // Without an image there is one all the same: the shader asks for it.
    const layers = Math.max(count, 1)
    gl.texStorage3D(gl.TEXTURE_2D_ARRAY, Math.log2(side) + 1, gl.RGBA8, side, side, layers)
    if (count) {
      const whole = [0, 0, 0, 0, side, side, count]
      gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, ...whole, gl.RGBA, gl.UNSIGNED_BYTE, plain(pixels))
      gl.generateMipmap(gl.TEXTURE_2D_ARRAY)
    }
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR)
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.LINEAR)
    for (const name of ["WRAP_S", "WRAP_T"]) {
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl[`TEXTURE_${name}`], gl.REPEAT)
    }
    gl.activeTexture(gl.TEXTURE0)
  }

  bind() {
    const {gl} = this
    gl.activeTexture(gl.TEXTURE0 + IMAGE_UNIT)
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.texture)
  }

  remove() {
    if (this.texture) { this.gl.deleteTexture(this.texture) }
  }
}

export class Materials {
  constructor(gl) {
    this.gl = gl
    this.corners = new PointTexture(gl, CORNER_UNIT)
    this.tints = new PointTexture(gl, TINT_UNIT)
  }

  // `corners`: of each corner its place in the image (two numbers), the image's layer, or -1, and
  // how the image repeats, 3 across + down: 0 repeats, 1 clamps, 2 mirrors; 9 more where what is
  // behind shines through. `tints`: its colour, and how much of it is there.
  set({corners, tints}) {
    const {gl} = this
    this.corners.put(plain(corners), gl.RGBA32F, gl.RGBA, gl.FLOAT, 4)
    this.tints.put(plain(tints), gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, 4)
  }

  // Called before the actor is drawn.
  use(program, images) {
    this.corners.use(program, "corners")
    this.tints.use(program, "tints")
    images.bind()
    program.setUniformi("images", IMAGE_UNIT)
  }

  remove() {
    this.corners.remove()
    this.tints.remove()
  }
}

// Additions to the shaders of vtk.js, which draw corners in the order of the triangles.
export const MATERIAL_SHADER = {
  declared: `
    uniform highp sampler2D corners;
    uniform highp sampler2D tints;
    varying vec4 corner;
    varying vec4 tint;`,
  main: `
    ivec2 cornerAt = ivec2(gl_VertexID % ${POINTS_WIDE}, gl_VertexID / ${POINTS_WIDE});
    corner = texelFetch(corners, cornerAt, 0);
    tint = texelFetch(tints, cornerAt, 0);`,
  fragment: [
    [FRAGMENT.main, `
      varying vec4 corner;
      varying vec4 tint;
      uniform highp sampler2DArray images;
      float wrapped(float at, float how, float edge) {
        if (how < 0.5) { return at; }
        return clamp(how < 1.5 ? at : 1.0 - abs(mod(at, 2.0) - 1.0), edge, 1.0 - edge);
      }
      // Of each two by two, and four by four pixels another share is drawn: nothing has to be
      // sorted by its distance then.
      float share(vec2 pixel) {
        pixel = floor(pixel);
        return fract(0.5 * pixel.x + 0.75 * pixel.y * pixel.y);
      }
      float dither(vec2 pixel) {
        return 0.25 * share(0.5 * pixel) + share(pixel) + 0.03125;
      }
      void main()
      {`],
    [FRAGMENT.ambient, `
      float edge = 0.5 / float(textureSize(images, 0).x);
      float least = corner.w > 8.5 ? dither(gl_FragCoord.xy) : 0.5;
      float how = corner.w > 8.5 ? corner.w - 9.0 : corner.w;
      float across = floor((how + 0.5) / 3.0);
      vec2 at = vec2(wrapped(corner.x, across, edge), wrapped(corner.y, how - 3.0 * across, edge));
      vec4 texel = texture(images, vec3(at, max(corner.z, 0.0)));
      if (corner.z < -0.5) { texel = vec4(1.0); }
      if (texel.a * tint.a < least) { discard; }
      vec3 shown = tint.rgb * texel.rgb;
      ambientColor = ambient < 0.9 ? shown : 0.45 * shown;  // edges have no other light`],
    [FRAGMENT.diffuse, "  diffuseColor = shown;"],
  ],
}
