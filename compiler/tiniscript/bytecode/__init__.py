"""The contract of compiler and machine: opcodes, images, the verifier, disassembly."""
