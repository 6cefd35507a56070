"""What is said of a staircase: tables, sentences, findings, the order of a report. It knows no medium."""
