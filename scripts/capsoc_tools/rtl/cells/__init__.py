"""The coprocessor in standard cells: Liberty, netlist, counted toggles, energy (scripts/tool power)."""
