// SPDX-License-Identifier: Apache-2.0
// The shift by products is the shift by places, for every word and each of the 16 places.
module shift_multiplier_properties (
  input logic               clk_i,
  input logic signed [38:0] data_i
);

  // With a constant scale the products are shifts, which a solver does not have to multiply out.
  for (genvar places = 0; places < 16; places = places + 1) begin : gen_places
    logic signed [38:0] data;
    shift_multiplier dut (.data_i, .places_i (4'(places)), .data_o (data));
    always @* assert (data == data_i >>> places);
  end

endmodule
