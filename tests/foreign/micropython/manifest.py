# What is built into MicroPython's image for its tests: code that the port has for that, and what they import.
freeze(
    "$(PORT_DIR)/test-frzmpy",
    ("frozen_asm_thumb.py", "frozen_const.py", "frozen_viper.py", "native_frozen_align.py"),
)
freeze(".", "unittest.py")
