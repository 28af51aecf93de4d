"""Messages to bytes and back: plain CDR as Fast DDS writes it, by Python code generated for each class.

It works for every class that follows rosidl_generator_py, compiled ones included, and needs only their SLOT_TYPES. The
wire format is little-endian XCDR1, which Fast DDS writes.
"""
