"""Fuzzers: cases made from a number, tried in processes with limits on memory and time.

python -m tests.fuzz.bind --count 2000
python -m tests.fuzz.bind --case 17
"""
