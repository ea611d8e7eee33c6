// How the browser's scripts are laid out. ESLint mends spaces, quotes, commas and indentation, and
// leaves line breaks as they are; oxlint finds mistakes.

import {createRequire} from "node:module"

const installed = createRequire(new URL("../../.venv/package.json", import.meta.url))
const stylistic = installed("@stylistic/eslint-plugin")
const style = stylistic.configs.customize({
  indent: 2, quotes: "double", semi: false, braceStyle: "1tbs", arrowParens: true,
})

export default [{ignores: ["app/frontend/vendor/preact.js"]}, {
  ...style,
  rules: {
    ...style.rules,
    "@stylistic/max-len": ["error", {code: 100}],
    "@stylistic/max-statements-per-line": "off",
    "@stylistic/multiline-ternary": "off",
    "@stylistic/no-multi-spaces": ["error", {ignoreEOLComments: true}],
    "@stylistic/object-curly-spacing": "error",
    "@stylistic/quotes": ["error", "double", {avoidEscape: true, allowTemplateLiterals: "always"}],
  },
}]
