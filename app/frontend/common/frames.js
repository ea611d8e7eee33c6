// What moves by itself, from one frame to the next.

const LONGEST = 100  // milliseconds: where frames are slower, motions are

// Calls a function with the seconds since its last call, in each frame; what is returned ends that.
export function eachFrame(move) {
  let last = null
  let waiting = 0
  const step = (now) => {
    waiting = requestAnimationFrame(step)
    move(last === null ? 0 : Math.min(now - last, LONGEST) / 1000)
    last = now
  }
  waiting = requestAnimationFrame(step)
  return () => cancelAnimationFrame(waiting)
}
