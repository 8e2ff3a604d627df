// Runs a JavaScript program; ours, the interpreter is not.
#include <stdio.h>

#include "duktape.h"

static const char program[] =
    "function sieve(n) { var s = [], p = 0; for (var i = 2; i <= n; i++) if (!s[i]) {"
    "  p++; for (var j = i * i; j <= n; j += i) s[j] = 1; } return p; }"
    "print('sieve', sieve(20000));"
    "print(JSON.stringify({a: [1, 2.5, null, {b: 'x'}], d: new Date(0).toISOString()}));"
    "print('abcabc'.replace(/(b)(c)/g, '<$2$1>'), /^(a+)+$/.test('aaaaaaaaaaaab'), 0.1 + 0.2, "
    "1e21);"
    "print(123456789.123.toFixed(2), (255).toString(16), Math.atan2(1, -1), parseInt('zz', 36));"
    "var o = []; for (var i = 0; i < 5000; i++) o.push((i * 7919) % 4999);"
    "o.sort(function (a, b) { return a - b; }); print(o[0], o[2500], o[4999]);"
    "try { null.x; } catch (e) { print(e); }"
    "print([1, 2, 3].map(function (x) { return x * x; }).reduce(function (a, b) { return a + b; "
    "}));"
    "function mandelbrot() { var n = 0; for (var y = 0; y < 20; y++) for (var x = 0; x < 40; x++) {"
    "  var a = 0, b = 0, k = 0; while (a * a + b * b < 4 && k < 50) {"
    "    var t = a * a - b * b + x / 20 - 1.5; b = 2 * a * b + y / 10 - 1; a = t; k++; } n += k; } "
    "return n; }"
    "print(mandelbrot(), eval('1+1'), new Function('a', 'return a * 2')(21), new Uint8Array([1, 2, "
    "300])[2]);";

static duk_ret_t print(duk_context* context) {
  duk_push_string(context, " ");
  duk_insert(context, 0);
  duk_join(context, duk_get_top(context) - 1);
  puts(duk_to_string(context, -1));
  return 0;
}

int main(void) {
  duk_context* context = duk_create_heap_default();
  duk_push_c_function(context, print, DUK_VARARGS);
  duk_put_global_string(context, "print");
  if (duk_peval_string(context, program)) {
    printf("error: %s\n", duk_safe_to_string(context, -1));
    return 1;
  }
  duk_destroy_heap(context);
  return 0;
}
