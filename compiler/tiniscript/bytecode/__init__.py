"""The contract between compiler and machine: opcodes, images, the verifier, disassembly."""
