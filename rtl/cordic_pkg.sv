// SPDX-License-Identifier: Apache-2.0
// Constants of the CORDICs, docs/reference/coprocessor.md. Word i of a table stands at [Width * i +: Width].
package cordic_pkg;

  // round(atan(2^-i) / 2pi * 2^37), i = 0..29: the precise arithmetic, 2^-37 turn.
  localparam logic [30*37-1:0] ANGLE_37 = {
    37'd41, 37'd81, 37'd163, 37'd326, 37'd652, 37'd1304, 37'd2608, 37'd5215, 37'd10430, 37'd20861,
    37'd41722, 37'd83443, 37'd166886, 37'd333772, 37'd667544, 37'd1335088, 37'd2670177,
    37'd5340354, 37'd10680707, 37'd21361408, 37'd42722775, 37'd85445225, 37'd170887842,
    37'd341754828, 37'd683342891, 37'd1365354594, 37'd2720152196, 37'd5358685036, 37'd10141868980,
    37'd17179869184};

  // round(atan(2^-i) / 2pi * 2^32), i = 0..27: the paper's arithmetic, 2^-32 turn.
  localparam logic [28*32-1:0] ANGLE_32 = {
    32'd5, 32'd10, 32'd20, 32'd41, 32'd81, 32'd163, 32'd326, 32'd652, 32'd1304, 32'd2608, 32'd5215,
    32'd10430, 32'd20861, 32'd41722, 32'd83443, 32'd166886, 32'd333772, 32'd667544, 32'd1335087,
    32'd2670163, 32'd5340245, 32'd10679838, 32'd21354465, 32'd42667331, 32'd85004756,
    32'd167458907, 32'd316933406, 32'd536870912};

  // Full scale times the gain K = 0.6072529350088813: round(K (2^31 - 1) 2^5), round(K (2^31 - 1)).
  localparam logic [37:0] START_38 = 38'd41730103921;
  localparam logic [32:0] START_33 = 33'd1304065748;

endpackage
