"""What is made of the settings of a peripheral: the registers that software alone writes and its hardware reads.

A setting is kept in flip-flops as it is written and has a parity bit. `sv_settings` makes the type of all of them and
the module that holds them, `setting_rows` their list for the programs that read or write the flip-flops.
"""

WORD_MASK = 0xFFFFFFFF


def setting_mask(register):
    """The bits that a write can set."""
    highest = register.write_range[1] if register.write_range else WORD_MASK
    return register.writable_mask & ((1 << highest.bit_length()) - 1)


def setting_error(register):
    """Why a register cannot be a setting, or None."""
    mask = setting_mask(register)
    if register.access != "read-write" or mask & (mask + 1) or not mask:
        return (
            f"{register.name} is no setting: its bits that can be written are not the lowest of a read-write register"
        )
    if register.reset & ~mask:
        return f"{register.name} is no setting: its reset value {register.reset:#x} has bits that cannot be written"
    return None


def setting_bits(register):
    return setting_mask(register).bit_length()


def flip_flops(register):
    return f"{register.name.lower()}_q"


def setting_rows(peripheral, notice):
    lines = [
        f"// {notice}",
        "// SETTING(name, bits): the flip-flops name_q. SETTING_PARITY(bits): parity_q, a bit for each row in order.",
    ]
    lines += [f"SETTING({each.name.lower()}, {setting_bits(each)})" for each in peripheral.settings]
    return "\n".join(lines + [f"SETTING_PARITY({len(peripheral.settings)})", ""])


def part_of(bus, register):
    """A bus's bits that the register keeps."""
    bits = setting_bits(register)
    return bus if bits == 32 else f"{bus}[{bits - 1}:0]"


def sv_type(peripheral, name):
    lines = ["// The settings, as the hardware reads them.", "typedef struct packed {"]
    for register in peripheral.settings:
        kind = f"logic [{setting_bits(register) - 1}:0]"
        if register.fields:
            kind = f"capsoc_{peripheral.name.lower()}_{register.name.lower()}_t"
        lines.append(f"  {kind} {register.name};")
    return lines + [f"}} {name}_t;"]


def sv_ports(name, selects):
    return [
        f"module {name} #(",
        "  parameter int Parity = 1,",
        "  parameter int Channels = 1",
        ") (",
        "  input  logic clk_i,",
        "  input  logic rst_ni,",
        "  input  logic clear_i,  // soft reset",
        "  input  logic write_i,  // of any register, and its value is not refused",
        f"  input  {selects}_t select_i,",
        "  input  logic [31:0] write_data_i,",
        "  input  logic bad_parity_i,  // a write leaves the wrong parity bit",
        f"  output {name}_t settings_o,",
        "  output logic fault_o,  // a setting does not fit its parity bit",
        "  input  logic shift_i,  // of the chain through a channel's context, chain_t",
        "  input  logic [40:0] chain_i,",
        "  output logic [40:0] chain_o",
        ");",
        "",
    ]


def sv_flip_flops(settings):
    """Those of one reset value share what a soft reset selects."""
    count = len(settings)
    by_reset = {}
    for register in settings:
        by_reset.setdefault(register.reset, []).append(register)
    source = {}
    selected = ", ".join(f"select_i.{register.name}" for register in reversed(settings))
    lines = [
        f"  logic [{count - 1}:0] written;",
        f"  assign written = {{{selected}}} & {{{count}{{write_i}}}};",
    ]
    for reset, registers in by_reset.items():
        data = f"{registers[0].name.lower()}_data"
        lines += [f"  logic [31:0] {data};", f"  assign {data} = clear_i ? 32'h{reset:08X} : write_data_i;"]
        source.update({register.name: data for register in registers})
    lines += [f"  logic [{setting_bits(each) - 1}:0] {flip_flops(each)};" for each in settings]
    bits = count + sum(map(setting_bits, settings))
    lines += [
        "  logic shift;",
        f"  logic [{bits - 1}:0] moved;",
        "  assign shift = Channels > 1 && shift_i;",
    ]
    lines += ["  always_ff @(posedge clk_i or negedge rst_ni) begin", "    if (!rst_ni) begin"]
    lines += [f"      {flip_flops(each)} <= {setting_bits(each)}'h{each.reset:X};" for each in settings]
    lines += [
        "    end else if (shift & ~clear_i) begin",
        f"      {{{', '.join(map(flip_flops, settings))}}} <= moved[{bits - count - 1}:0];",
        "    end else begin",
    ]
    for place, register in enumerate(settings):
        data = part_of(source[register.name], register)
        lines += [f"      if (clear_i | written[{place}]) {flip_flops(register)} <= {data};"]
    unused = [
        f"{data}[31:{max(map(setting_bits, registers))}]"
        for data, registers in ((source[group[0].name], group) for group in by_reset.values())
        if max(map(setting_bits, registers)) < 32
    ]
    lines += ["    end", "  end"]
    if unused:
        lines += [
            "  logic unused_data;  // bits that no setting keeps",
            f"  assign unused_data = ^{{{', '.join(unused)}}};",
        ]
    return lines


def sv_parity(settings):
    """A value above a range is refused, so all bits of a word count that are no reserved bits."""
    count = len(settings)

    def joined(terms):
        return "{" + ", ".join(reversed(terms)) + "}"

    following = [
        "word_parity" if each.writable_mask == WORD_MASK else f"^{part_of('write_data_i', each)}" for each in settings
    ]
    total = count + sum(map(setting_bits, settings))
    kept = ", ".join(["parity_q", *map(flip_flops, settings)])
    resets = "".join(str(each.reset.bit_count() % 2) for each in reversed(settings))
    return [
        "",
        "  // A parity bit for each, in the order of the list.",
        f"  logic [{count - 1}:0] parity_q, next_parity, parity;",
        "  logic word_parity;",
        "  assign word_parity = ^write_data_i;",
        f"  assign next_parity = {joined(following)} ^ {{{count}{{bad_parity_i}}}};",
        f"  localparam logic [{count - 1}:0] ResetParity = {{{count}{{Parity != 0}}}} & {count}'b{resets};",
        "  always_ff @(posedge clk_i or negedge rst_ni) begin",
        "    if (!rst_ni) parity_q <= ResetParity;",
        "    else if (clear_i) parity_q <= ResetParity;",
        "    else if (|written)",
        f"      parity_q <= ((parity_q & ~written) | (next_parity & written)) & {{{count}{{Parity != 0}}}};",
        f"    else if (shift) parity_q <= moved[{total - 1}:{total - count}];",
        "  end",
        f"  assign parity = {joined([f'^{flip_flops(each)}' for each in settings])};",
        "  assign fault_o = Parity != 0 & (|(parity ^ parity_q));",
        f"  context_chain #(.Channels(Channels), .Width({total})) u_chain (",
        f"    .kept_i({{{kept}}}), .chain_i, .moved_o(moved), .chain_o",
        "  );",
    ]


def sv_settings(peripheral, notice):
    """The type stands outside of a package, for the reason that rtl/coprocessor_types.sv gives."""
    name = f"capsoc_{peripheral.name.lower()}_settings"
    lines = [f"// {notice}"]
    lines += sv_type(peripheral, name) + [""]
    lines += sv_ports(name, f"capsoc_{peripheral.name.lower()}_selects")
    lines += sv_flip_flops(peripheral.settings)
    lines += [
        f"  assign settings_o.{each.name} = {f'32{chr(39)}({flip_flops(each)})' if each.fields else flip_flops(each)};"
        for each in peripheral.settings
    ]
    lines += sv_parity(peripheral.settings)
    lines += [
        "",
        "  logic unused_selects;  // of the other registers",
        "  assign unused_selects = ^select_i;",
    ]
    return "\n".join(lines + ["", f"endmodule : {name}", ""])
