/* The shipped vocabulary as it is, byte by byte, in the constant data of every program that links it. */
  .section .rodata
  .globl pangaea_shipped_vocabulary_begin
  .globl pangaea_shipped_vocabulary_end
  .balign 16
pangaea_shipped_vocabulary_begin:
  .incbin PANGAEA_SHIPPED_VOCABULARY
pangaea_shipped_vocabulary_end:
  .section .note.GNU-stack, "", %progbits
