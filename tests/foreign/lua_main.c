// Runs a Lua program that touches most of the language; ours, the interpreter is not.
#include <stdio.h>

#include "lauxlib.h"
#include "lua.h"
#include "lualib.h"

static const char program[] =
    "local t = {} for i = 1, 20000 do t[i] = (i * 7919) % 10007 end table.sort(t)\n"
    "local s = 0 for i, v in ipairs(t) do s = s + i * v end print('sort', s)\n"
    "local function fib(n) if n < 2 then return n end return fib(n - 1) + fib(n - 2) end "
    "print('fib', fib(24))\n"
    "print(string.format('%5.3f %g %q %x', math.pi, 1e100, 'a\\nb', 255), math.sin(1), 2 ^ 0.5, 7 "
    "// 2, -7 // 2)\n"
    "print(-7 % 3, 1 << 62, math.maxinteger, 5.5 // 0.7, 0 / 0, 1 / 0, -1 / 0, 0x7fffffffffffffff "
    "+ 1)\n"
    "local squares = coroutine.wrap(function() for i = 1, 5 do coroutine.yield(i * i) end end)\n"
    "for i = 1, 5 do io.write(squares(), ' ') end print()\n"
    "print(('the quick brown fox'):gsub('%w+', function(w) return w:reverse():upper() end))\n"
    "print(pcall(function() local x = nil return x.y end), select('#', 1, nil, 3))\n"
    "local sum = 0 for i = 1, 300 do sum = sum + load('return ' .. i .. ' * 2 + ' .. i .. ' / "
    "3')() end print(sum)\n"
    "local m = setmetatable({}, {__index = function(_, k) return k * 2 end, __call = function(_, "
    "a, b) return a .. b end})\n"
    "print(m[21], m('x', 'y'))\n"
    "collectgarbage('generational') for i = 1, 20000 do local x = {i, {i}} end "
    "print(collectgarbage('count') > 0)\n"
    "print(string.pack('<i4>d', 77, 1.5):byte(1, -1)) print(utf8.char(228, 8364, 0x10ffff), "
    "#utf8.char(8364))\n"
    "local queen, found = {}, 0\n"
    "local function place(r)\n"
    "  if r > 8 then found = found + 1 return end\n"
    "  for c = 1, 8 do\n"
    "    local free = true\n"
    "    for k = 1, r - 1 do\n"
    "      local d = queen[k] - c\n"
    "      if d == 0 or d == r - k or d == k - r then free = false break end\n"
    "    end\n"
    "    if free then queen[r] = c place(r + 1) end\n"
    "  end\n"
    "end\n"
    "place(1) print('queens', found)\n";

int main(void) {
  lua_State* lua = luaL_newstate();
  luaL_openlibs(lua);
  if (luaL_dostring(lua, program)) {
    printf("error: %s\n", lua_tostring(lua, -1));
    return 1;
  }
  lua_close(lua);
  return 0;
}
