"""The program against laboratory experiments: measured tables, fits, predictions. It knows no command and no study."""
